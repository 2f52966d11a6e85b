/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/estimate/linear.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#define SWEEPS_MAX 60

static double column_dot(const double *a, const double *b, int count)
{
	double sum = 0;

	for (int i = 0; i < count; i++)
		sum += a[i] * b[i];
	return sum;
}

void linear_scale(double *a, int rows, int columns, double *length)
{
	for (int j = 0; j < columns; j++) {
		double *column = a + (size_t)j * (size_t)rows;
		double largest = 0, size;

		for (int i = 0; i < rows; i++)
			largest = fmax(largest, fabs(column[i]));
		for (int i = 0; i < rows && largest > 0; i++)
			column[i] /= largest;
		size = sqrt(column_dot(column, column, rows));
		for (int i = 0; i < rows && largest > 0; i++)
			column[i] /= size;
		length[j] = largest > 0 ? largest * size : 1;
	}
}

void linear_triangulate(double *a, int rows, int columns, int kept, double *r)
{
	for (int j = 0; j < kept; j++) {
		double *v = a + (size_t)j * (size_t)rows;
		const double size = sqrt(column_dot(v + j, v + j, rows - j));
		const double head = v[j] > 0 ? -size : size;
		double reach;

		for (int i = 0; i < kept; i++)
			r[j * kept + i] = i < j ? v[i] : 0;
		r[j * kept + j] = head;
		v[j] -= head;
		reach = column_dot(v + j, v + j, rows - j);
		for (int k = j + 1; k < columns && reach > 0; k++) {
			double *other = a + (size_t)k * (size_t)rows;
			const double part = 2 * column_dot(v + j, other + j, rows - j) / reach;

			for (int i = j; i < rows; i++)
				other[i] -= part * v[i];
		}
	}
	for (int j = kept; j < columns; j++)
		memcpy(r + (size_t)j * (size_t)kept, a + (size_t)j * (size_t)rows,
		       (size_t)kept * sizeof(*r));
}

static void rotate_columns(double *a, double *b, int count, double c, double s)
{
	for (int i = 0; i < count; i++) {
		const double x = a[i], y = b[i];

		a[i] = c * x - s * y;
		b[i] = s * x + c * y;
	}
}

/* Makes columns p and q of r orthogonal by a Jacobi rotation. False: they are already. */
static bool jacobi_rotate(double *r, double *v, int n, int p, int q)
{
	double *a = r + (size_t)p * (size_t)n, *b = r + (size_t)q * (size_t)n;
	const double aa = column_dot(a, a, n), bb = column_dot(b, b, n), ab = column_dot(a, b, n);
	double zeta, t, c;

	if (fabs(ab) <= DBL_EPSILON * sqrt(aa * bb) || ab == 0)
		return false;
	zeta = (bb - aa) / (2 * ab);
	t = copysign(1, zeta) / (fabs(zeta) + hypot(1, zeta));
	c = 1 / hypot(1, t);
	rotate_columns(a, b, n, c, c * t);
	rotate_columns(v + (size_t)p * (size_t)n, v + (size_t)q * (size_t)n, n, c, c * t);
	return true;
}

void linear_diagonalize(double *r, double *v, int n)
{
	bool turned = true;

	memset(v, 0, (size_t)n * (size_t)n * sizeof(*v));
	for (int k = 0; k < n; k++)
		v[k * n + k] = 1;
	for (int sweep = 0; sweep < SWEEPS_MAX && turned; sweep++) {
		turned = false;
		for (int p = 0; p < n; p++)
			for (int q = p + 1; q < n; q++)
				turned |= jacobi_rotate(r, v, n, p, q);
	}
}

double linear_solve(double *a, int rows, int columns, double *x)
{
	double r[(LINEAR_SMALL_MAX + 1) * LINEAR_SMALL_MAX], v[LINEAR_SMALL_MAX * LINEAR_SMALL_MAX];
	double length[LINEAR_SMALL_MAX], least = INFINITY, most = 0;
	const double *b = r + columns * columns;

	linear_scale(a, rows, columns, length);
	linear_triangulate(a, rows, columns + 1, columns, r);
	linear_diagonalize(r, v, columns);
	memset(x, 0, (size_t)columns * sizeof(*x));
	for (int k = 0; k < columns; k++) {
		const double *w = r + k * columns;
		const double square = column_dot(w, w, columns);
		const double part = square > 0 ? column_dot(w, b, columns) / square : 0;

		least = fmin(least, square);
		most = fmax(most, square);
		for (int i = 0; i < columns; i++)
			x[i] += part * v[k * columns + i] / length[i];
	}
	return most > 0 ? sqrt(least / most) : 0;
}

double linear_null(double *a, int rows, int columns, double *x)
{
	double r[LINEAR_SMALL_MAX * LINEAR_SMALL_MAX], v[LINEAR_SMALL_MAX * LINEAR_SMALL_MAX];
	double least = INFINITY, second = INFINITY, most = 0;
	int at = 0;

	linear_triangulate(a, rows, columns, columns, r);
	linear_diagonalize(r, v, columns);
	for (int k = 0; k < columns; k++) {
		const double square = column_dot(r + k * columns, r + k * columns, columns);

		most = fmax(most, square);
		if (square < least) {
			second = least;
			least = square;
			at = k;
		} else {
			second = fmin(second, square);
		}
	}
	memcpy(x, v + at * columns, (size_t)columns * sizeof(*x));
	return most > 0 ? sqrt(second / most) : 0;
}

static double length_of(const double *a, int count)
{
	double sum = 0;

	for (int i = 0; i < count; i++)
		sum += a[i] * a[i];
	return sqrt(sum);
}

/* Indices of the two largest entries of a unit vector; the first one twice where the others are
 * about 0. */
static void name_worst(const double *v, int n, int worst[2])
{
	int first = 0, second = -1;

	for (int k = 1; k < n; k++)
		if (fabs(v[k]) > fabs(v[first]))
			first = k;
	for (int k = 0; k < n; k++)
		if (k != first && (second < 0 || fabs(v[k]) > fabs(v[second])))
			second = k;
	worst[0] = first;
	worst[1] = second >= 0 && fabs(v[second]) > 1e-3 ? second : first;
}

/* inverse = V S^-2 V^T, with the scaling of the columns undone. Singular values up to least count
 * as 0. */
static void assemble_covariance(const double *v, const double *singular, double least,
				const double *length, int n, double *inverse)
{
	for (int a = 0; a < n; a++)
		for (int b = 0; b < n; b++) {
			double sum = 0, lost = 0;

			for (int k = 0; k < n; k++) {
				const double part = v[k * n + a] * v[k * n + b];

				if (singular[k] > least)
					sum += part / (singular[k] * singular[k]);
				else
					lost += a == b ? part : 0;
			}
			inverse[a * n + b] = lost > 1e-12 ? INFINITY : sum / length[a] / length[b];
		}
}

int covariance_find(const struct covariance_task *task, double *inverse, double *condition,
		    int worst[2])
{
	const int n = task->columns;
	const size_t square = (size_t)n * (size_t)n;
	double *work = calloc(2 * square + 2 * (size_t)n, sizeof(*work));
	double *r = work, *v, *length, *singular, largest = 0;
	int weakest = 0;

	if (!work)
		return -ENOMEM;
	v = r + square;
	length = v + square;
	singular = length + n;
	linear_scale(task->jacobian, task->rows, n, length);
	linear_triangulate(task->jacobian, task->rows, n, n, r);
	linear_diagonalize(r, v, n);
	for (int k = 0; k < n; k++) {
		singular[k] = length_of(r + (size_t)k * (size_t)n, n);
		largest = fmax(largest, singular[k]);
		if (singular[k] < singular[weakest])
			weakest = k;
	}
	name_worst(v + (size_t)weakest * (size_t)n, n, worst);
	assemble_covariance(v, singular, task->rounding * largest, length, n, inverse);
	*condition = INFINITY;
	if (singular[weakest] > task->rounding * largest)
		*condition = (largest / singular[weakest]) * (largest / singular[weakest]);
	free(work);
	return isinf(*condition) ? -ERANGE : 0;
}
