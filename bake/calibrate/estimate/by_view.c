/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/estimate/least_squares.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/estimate/linear.h"

#define SMOOTH 12      /* both coordinates by 1, x, y, x^2, xy, y^2 */
#define BENDS 3	       /* of a board: x^2, xy, y^2 */
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
	double *cleared, *unbent; /* unbent: less what bent boards explain, too */
	int bends;		  /* columns */
	struct basis of_view, lens;
	double *r; /* [shared][shared]: columns of R */
	int axis;  /* its first column; -1: it is held */
};

static int first_row(const struct by_view_task *task, int view)
{
	return task->group * task->layout->first(task->context, view);
}

/* Squares of the residuals that the last column of the basis explains. */
static double squares_of_last(const struct basis *basis, const double *residual)
{
	const double along = product(basis_at(basis, basis->count - 1), residual, basis->rows);

	return along * along;
}

/* Fills a column with a smooth error of the picture around middle; only the span of all matters. */
static void fill_smooth(const struct by_view_task *task, int first, int rows, int which,
			const double middle[2], double *column)
{
	static const int power[SMOOTH / 2][2] = {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}};
	const int *p = power[which / 2];

	for (int i = 0; i < rows; i++) {
		const double *px = task->layout->place(task->context, (first + i) / task->group);

		column[i] = 0;
		if (i % task->group == which % 2)
			column[i] = pow(px[0] - middle[0], p[0]) * pow(px[1] - middle[1], p[1]);
	}
}

/* Adds what the view's pose and axis leave of smooth errors: squares of the residuals along each,
 * and as degrees of freedom the squares of the errors' own lengths. */
static void weigh_smooth(struct clearing *work, int first, const double *residual,
			 struct by_view *found)
{
	const struct by_view_task *task = work->task;
	const struct basis *known = &work->of_view;
	struct basis smooth = {.column = basis_at(known, known->count), .rows = known->rows};
	double middle[2] = {0, 0}, *column = basis_at(&smooth, SMOOTH);

	for (int i = 0; i < known->rows; i += task->group)
		for (int k = 0; k < 2; k++)
			middle[k] += task->layout->place(task->context,
							 (first + i) / task->group)[k] *
				     task->group / known->rows;
	for (int k = 0; k < SMOOTH; k++) {
		fill_smooth(task, first, known->rows, k, middle, column);
		if (!(basis_add(&smooth, column, NULL) > 0))
			continue;
		memcpy(column, basis_at(&smooth, smooth.count - 1),
		       (size_t)known->rows * sizeof(*column));
		basis_clear(known, column, NULL);
		found->smooth_squares += pow(product(column, residual, known->rows), 2);
		found->smooth_freedom += product(column, column, known->rows);
	}
}

static void test_view(struct clearing *work, int view, int first, struct by_view *found,
		      double *worst)
{
	struct basis *basis = &work->of_view;
	const size_t rows = (size_t)work->task->rows;
	const double *residual = work->cleared + (size_t)found->shared * rows + first;
	double squares = 0;

	for (int k = 0; k < 2; k++)
		if (basis_add(basis, work->cleared + (size_t)(work->axis + k) * rows + first,
			      NULL) > 0) {
			squares += squares_of_last(basis, residual);
			found->axis_freedom++;
		}
	found->axis_squares += squares;
	if (squares > *worst) {
		*worst = squares;
		found->odd = view;
	}
	weigh_smooth(work, first, residual, found);
}

/* Subtracts what the basis explains from one view's rows of all shared columns and the
 * residuals. */
static void clear_rows(const struct clearing *work, int first, int shared, double *columns)
{
	for (int k = 0; k <= shared; k++)
		basis_clear(&work->of_view, columns + (size_t)k * (size_t)work->task->rows + first,
			    NULL);
}

/* Fills unbent for a view, whose pose is the basis: its board may be bent along its normal. moved:
 * the columns of its translation. */
static void unbend_view(struct clearing *work, int view, int first, const double *const moved[3],
			int shared)
{
	const struct by_view_task *task = work->task;
	struct basis *basis = &work->of_view;
	const int pose = basis->count;
	double *bend = basis_at(basis, pose + BENDS), normal[3];

	for (int k = 0; k < BENDS && task->layout->normal &&
			task->layout->normal(task->context, task->x, view, normal);
	     k++) {
		for (int i = 0; i < basis->rows; i++) {
			double at[2];

			task->layout->on_board(task->context, (first + i) / task->group, at);
			bend[i] = at[k / 2] * at[(k + 1) / 2] *
				  (normal[0] * moved[0][i] + normal[1] * moved[1][i] +
				   normal[2] * moved[2][i]);
		}
		basis_add(basis, bend, NULL);
	}
	clear_rows(work, first, shared, work->unbent);
	work->bends += basis->count - pose;
	basis->count = pose;
}

/* Subtracts from all columns of one view what its own unknowns explain. */
static void clear_view(struct clearing *work, int view, int *column, struct by_view *found,
		       double *worst)
{
	const struct by_view_task *task = work->task;
	const struct by_view_layout *layout = task->layout;
	const int first = first_row(task, view),
		  end = layout->shared + (view + 1) * layout->of_view;
	const size_t rows = (size_t)task->rows;
	const double *moved[3] = {NULL};
	struct basis *basis = &work->of_view;

	basis->rows = first_row(task, view + 1) - first;
	basis->count = 0;
	for (; *column < task->columns && task->parameter[*column] < end; ++*column) {
		moved[0] = moved[1];
		moved[1] = moved[2];
		moved[2] = task->jacobian + (size_t)*column * rows + first;
		if (basis->rows > layout->of_view)
			basis_add(basis, moved[2], NULL);
	}
	if (basis->rows <= layout->of_view) {
		for (int k = 0; k <= found->shared; k++)
			memset(work->cleared + (size_t)k * rows + first, 0,
			       (size_t)basis->rows * sizeof(double));
		return;
	}
	clear_rows(work, first, found->shared, work->cleared);
	found->views++;
	if (work->axis < 0)
		return;
	if (basis->rows > layout->of_view + BENDS)
		unbend_view(work, view, first, moved, found->shared);
	test_view(work, view, first, found, worst);
}

/* Finds whether bent boards explain the residuals better than a moving axis does. */
static void compare_bends(struct clearing *work, struct by_view *found)
{
	const int rows = work->task->rows, left = rows - work->task->columns;
	const size_t last = (size_t)found->shared * (size_t)rows;
	const double *by_axis = work->cleared + last;
	double *by_bends = work->unbent + last;

	for (int k = 0; k < found->shared; k++)
		basis_add(&work->lens, work->unbent + (size_t)k * (size_t)rows, NULL);
	basis_clear(&work->lens, by_bends, NULL);
	work->lens.count = 0;
	found->bent = product(by_bends, by_bends, rows) * (left - found->axis_freedom) <
		      (product(by_axis, by_axis, rows) - found->axis_squares) *
			      (left - work->bends);
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

/* Counts the shared columns and finds the axis among them; returns the longest view's rows. */
static int survey(struct clearing *work, struct by_view *found)
{
	const struct by_view_task *task = work->task;
	int longest = 0;

	work->axis = -1;
	for (;
	     found->shared < task->columns && task->parameter[found->shared] < task->layout->shared;
	     found->shared++)
		if (task->parameter[found->shared] == task->layout->axis)
			work->axis = found->shared;
	if (work->axis >= 0 && (work->axis + 1 == found->shared ||
				task->parameter[work->axis + 1] != task->layout->axis + 1))
		work->axis = -1;
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
	double *room, worst = 0;
	size_t longest, n;
	int column, err = -ENOMEM;

	*found = (struct by_view){.views = 0};
	longest = (size_t)survey(&work, found);
	n = (size_t)found->shared;
	if (!n)
		return 0;
	work.cleared = malloc((n + 1) * rows * sizeof(double));
	work.unbent = malloc((n + 1) * rows * sizeof(double));
	work.of_view.column =
		malloc((size_t)(task->layout->of_view + 3 + SMOOTH) * longest * sizeof(double));
	work.lens.column = malloc(n * rows * sizeof(double));
	work.lens.rows = task->rows;
	work.r = calloc(n * n, sizeof(double));
	found->excess = calloc(n * n, sizeof(double));
	room = calloc((3 * n + 1) * n, sizeof(double));
	if (work.cleared && work.unbent && work.of_view.column && work.lens.column && work.r &&
	    found->excess && room) {
		err = 0;
		memcpy(work.cleared, task->jacobian, n * rows * sizeof(double));
		memcpy(work.cleared + n * rows, task->residual, rows * sizeof(double));
		memcpy(work.unbent, work.cleared, (n + 1) * rows * sizeof(double));
		column = found->shared;
		for (int v = 0; v < task->layout->views; v++)
			clear_view(&work, v, &column, found, &worst);
		found->axis_freedom = found->axis_freedom > 2 ? found->axis_freedom - 2 : 0;
		if (work.axis >= 0)
			compare_bends(&work, found);
		if (found->views > 1)
			find_scatter(&work, room, found);
	}
	free(work.cleared);
	free(work.unbent);
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

/* Survival function of the F distribution: that of the beta distribution, a finite sum because one
 * of its parameters is a whole number. */
double by_view_chance(double squares, int freedom, double other_squares, double other_freedom)
{
	const double x = squares / (squares + other_squares), b = other_freedom / 2;
	double term = b * log1p(-x), sum = 0; /* the logarithm of a term */

	if (freedom < 2 || !(other_freedom > 0) || !(squares > 0))
		return 1;
	for (int i = 0; i < freedom / 2; i++) {
		sum += exp(term);
		term += log(x * (b + i) / (i + 1));
	}
	return fmin(sum, 1);
}

double by_view_axis_chance(const struct by_view *found, double variance, int freedom)
{
	const double noise = by_view_chance(found->axis_squares, found->axis_freedom,
					    variance * freedom, freedom);

	if (found->bent)
		return 1;
	if (found->smooth_freedom < 1) /* as few points as unknowns */
		return noise;
	return fmax(noise, by_view_chance(found->axis_squares, found->axis_freedom,
					  found->smooth_squares, found->smooth_freedom));
}
