/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/estimate/least_squares.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/estimate/linear.h"

#define DEPENDENT 1e-6 /* length left of a unit column that others explain */
#define LONE 1e-6      /* 1 - leverage of a view that alone tells a direction */

static double product(const double *a, const double *b, int rows)
{
	double sum = 0;

	for (int i = 0; i < rows; i++)
		sum += a[i] * b[i];
	return sum;
}

/* Orthonormal columns [count][rows]. */
struct basis {
	double *column;
	int rows, count;
};

static double *basis_at(const struct basis *basis, int k)
{
	return basis->column + (size_t)k * (size_t)basis->rows;
}

/* Subtracts from a column what the basis explains, twice because of rounding. part[count], or NULL,
 * receives how much that is. */
static void basis_clear(const struct basis *basis, double *column, double *part)
{
	for (int k = 0; part && k < basis->count; k++)
		part[k] = 0;
	for (int k = 0; k < 2 * basis->count; k++) {
		const double *other = basis_at(basis, k % basis->count);
		const double along = product(other, column, basis->rows);

		for (int i = 0; i < basis->rows; i++)
			column[i] -= along * other[i];
		if (part)
			part[k % basis->count] += along;
	}
}

/* Adds what a column has that the basis does not explain; returns its length, 0 if that is nothing
 * but rounding. */
static double basis_add(struct basis *basis, const double *column, double *part)
{
	double *added = basis_at(basis, basis->count);
	const double before = sqrt(product(column, column, basis->rows));
	double length;

	memcpy(added, column, (size_t)basis->rows * sizeof(*added));
	basis_clear(basis, added, part);
	length = sqrt(product(added, added, basis->rows));
	if (!(length > DEPENDENT * before))
		return 0;
	for (int i = 0; i < basis->rows; i++)
		added[i] /= length;
	basis->count++;
	return length;
}

/* Work of by_view_find(). */
struct clearing {
	const struct by_view_task *task;
	/* [shared + 1][rows]: shared columns and residuals less what poses explain */
	double *cleared;
	struct basis of_view, lens;
	double *r; /* [shared][shared]: columns of R */
};

static int first_row(const struct by_view_task *task, int view)
{
	return task->group * task->layout->first(task->context, view);
}

/* Subtracts from the shared columns and the residuals of one view what its own unknowns explain. */
static void clear_view(struct clearing *work, int view, int *column, struct by_view *found)
{
	const struct by_view_task *task = work->task;
	const struct by_view_layout *layout = task->layout;
	const int first = first_row(task, view),
		  end = layout->shared + (view + 1) * layout->of_view;
	const size_t rows = (size_t)task->rows;
	struct basis *basis = &work->of_view;
	bool lone;

	basis->rows = first_row(task, view + 1) - first;
	basis->count = 0;
	lone = basis->rows <= layout->of_view;
	for (; *column < task->columns && task->parameter[*column] < end; ++*column)
		if (!lone)
			basis_add(basis, task->jacobian + (size_t)*column * rows + first, NULL);
	for (int k = 0; k <= found->shared; k++) {
		double *cleared = work->cleared + (size_t)k * rows + first;

		if (lone)
			memset(cleared, 0, (size_t)basis->rows * sizeof(*cleared));
		else
			basis_clear(basis, cleared, NULL);
	}
	found->views += !lone;
}

/* Adds z' of one view to Z. room: [2 shared + 1][shared]. */
static void add_pull(const struct clearing *work, int view, int shared, double *room, double *z)
{
	const int first = first_row(work->task, view), end = first_row(work->task, view + 1);
	const double *residual = work->cleared + (size_t)shared * (size_t)work->task->rows;
	double *leverage = room, *v = room + shared * shared, *pull = v + shared * shared;

	for (int a = 0; a < shared; a++)
		for (int b = 0; b < shared; b++)
			leverage[a * shared + b] = product(basis_at(&work->lens, a) + first,
							   basis_at(&work->lens, b) + first,
							   end - first);
	linear_diagonalize(leverage, v, shared);
	memset(pull, 0, (size_t)shared * sizeof(*pull));
	for (int k = 0; k < shared; k++) {
		const double *direction = v + k * shared;
		const double own =
			sqrt(product(leverage + k * shared, leverage + k * shared, shared));
		double along = 0;

		for (int a = 0; a < shared; a++)
			along += direction[a] * product(basis_at(&work->lens, a) + first,
							residual + first, end - first);
		for (int a = 0; a < shared; a++)
			pull[a] += direction[a] * along / sqrt(fmax(1 - own, LONE));
	}
	for (int a = 0; a < shared; a++)
		for (int b = 0; b < shared; b++)
			z[a * shared + b] += pull[a] * pull[b];
}

/* Shrinks Z towards its diagonal, and where there are no more views than unknowns the diagonal
 * towards its mean. Fills mean and excess. r[b][a]: column b of R. */
static void shrink(struct by_view *found, double *z, const double *r)
{
	const int n = found->shared, freedom = found->views - 1;
	double trace = 0, squares = 0, rho = 1, apart;

	for (int a = 0; a < n; a++)
		trace += z[a * n + a];
	for (int k = 0; k < n * n; k++)
		squares += z[k] * z[k];
	found->mean = trace / n;
	apart = (freedom + 1 - 2.0 / n) * (squares - trace * trace / n);
	if (apart > 0)
		rho = fmin(1, ((1 - 2.0 / n) * squares + trace * trace) / apart);
	for (int a = 0; a < n; a++)
		for (int b = 0; b < n; b++)
			z[a * n + b] = (a == b && freedom >= n ? 1 : 1 - rho) *
				       (z[a * n + b] - (a == b ? found->mean : 0));
	for (int a = 0; a < n; a++)
		for (int b = 0; b < n; b++) {
			double sum = 0;

			for (int i = 0; i < n; i++)
				for (int j = 0; j < n; j++)
					sum += r[a * n + i] * z[i * n + j] * r[b * n + j];
			found->excess[a * n + b] = sum;
		}
}

/* Finds Q and R of the shared columns, then Z. */
static void find_scatter(struct clearing *work, double *room, struct by_view *found)
{
	const int shared = found->shared;
	double *z = room + (2 * shared + 1) * shared;

	for (int k = 0; k < shared; k++) {
		const double length =
			basis_add(&work->lens, work->cleared + (size_t)k * (size_t)work->task->rows,
				  work->r + k * shared);

		if (!(length > 0)) {
			found->views = 0;
			return;
		}
		work->r[k * shared + k] = length;
	}
	for (int v = 0; v < work->task->layout->views; v++)
		add_pull(work, v, shared, room, z);
	shrink(found, z, work->r);
}

/* Counts the shared columns; returns the longest view's rows. */
static int survey(const struct by_view_task *task, struct by_view *found)
{
	int longest = 0;

	while (found->shared < task->columns &&
	       task->parameter[found->shared] < task->layout->shared)
		found->shared++;
	for (int v = 0; v < task->layout->views; v++) {
		const int rows = first_row(task, v + 1) - first_row(task, v);

		longest = rows > longest ? rows : longest;
	}
	return longest;
}

int by_view_find(const struct by_view_task *task, struct by_view *found)
{
	struct clearing work = {.task = task};
	const size_t rows = (size_t)task->rows;
	double *room;
	size_t longest, n;
	int column, err = -ENOMEM;

	*found = (struct by_view){.views = 0};
	longest = (size_t)survey(task, found);
	n = (size_t)found->shared;
	if (!n)
		return 0;
	work.cleared = malloc((n + 1) * rows * sizeof(double));
	work.of_view.column =
		malloc((size_t)(task->layout->of_view + 1) * longest * sizeof(double));
	work.lens.column = malloc(n * rows * sizeof(double));
	work.lens.rows = task->rows;
	work.r = calloc(n * n, sizeof(double));
	found->excess = calloc(n * n, sizeof(double));
	room = calloc((3 * n + 1) * n, sizeof(double));
	if (work.cleared && work.of_view.column && work.lens.column && work.r && found->excess &&
	    room) {
		err = 0;
		memcpy(work.cleared, task->jacobian, n * rows * sizeof(double));
		memcpy(work.cleared + n * rows, task->residual, rows * sizeof(double));
		column = found->shared;
		for (int v = 0; v < task->layout->views; v++)
			clear_view(&work, v, &column, found);
		if (found->views > 1)
			find_scatter(&work, room, found);
	}
	free(work.cleared);
	free(work.of_view.column);
	free(work.lens.column);
	free(work.r);
	free(room);
	return err;
}

void by_view_free(struct by_view *found)
{
	free(found->excess);
	*found = (struct by_view){.views = 0};
}

/* The shared unknowns move the poses as the inverse says, X being its first columns:
 *     covariance = mean inverse + X excess X^T */
void by_view_spread(const struct by_view *found, double mean, const double *inverse, int columns,
		    double *covariance)
{
	const int shared = found->shared;

	for (int a = 0; a < columns; a++)
		for (int i = 0; i < shared; i++) {
			double by = 0;

			for (int j = 0; j < shared; j++)
				by += inverse[a * columns + j] * found->excess[j * shared + i];
			for (int b = 0; b < columns; b++)
				covariance[a * columns + b] +=
					by * inverse[b * columns + i] +
					(i ? 0 : mean * inverse[a * columns + b]);
		}
}
