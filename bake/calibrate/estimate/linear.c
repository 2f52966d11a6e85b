/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/estimate/linear.h"

#include <errno.h>
#include <lapacke.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* Scales columns to unit length. length[columns] receives the old lengths, 1 for columns of
 * zeros. */
static void linear_scale(double *a, int rows, int columns, double *length)
{
	for (int j = 0; j < columns; j++) {
		double *column = a + (size_t)j * (size_t)rows;
		double largest = 0, square = 0;

		for (int i = 0; i < rows; i++)
			largest = fmax(largest, fabs(column[i]));
		for (int i = 0; i < rows && largest > 0; i++)
			square += (column[i] / largest) * (column[i] / largest);
		length[j] = largest > 0 ? largest * sqrt(square) : 1;
		for (int i = 0; i < rows; i++)
			column[i] /= length[j];
	}
}

int linear_decompose(double *a, int rows, int columns, double *singular, double *v)
{
	const size_t n = (size_t)columns;
	double *superdiagonal = malloc(n * sizeof(*superdiagonal)), none;
	int info = superdiagonal
			   ? LAPACKE_dgesvd(LAPACK_COL_MAJOR, 'N', 'A', rows, columns, a, rows,
					    singular, &none, 1, v, columns, superdiagonal)
			   : -1;

	free(superdiagonal);
	if (info > 0) { /* no convergence: nothing is known of any direction */
		memset(singular, 0, n * sizeof(*singular));
		memset(v, 0, n * n * sizeof(*v));
	}
	for (size_t j = 0; j < n; j++)
		for (size_t k = 0; k < j; k++) {
			const double swap = v[j * n + k];

			v[j * n + k] = v[k * n + j];
			v[k * n + j] = swap;
		}
	return info < 0 ? -ENOMEM : 0;
}

double linear_solve(double *a, int rows, int columns, double *x)
{
	double length[LINEAR_SMALL_MAX], singular[LINEAR_SMALL_MAX];
	double *b = a + (size_t)columns * (size_t)rows;
	int rank, info;

	linear_scale(a, rows, columns, length);
	info = LAPACKE_dgelsd(LAPACK_COL_MAJOR, rows, columns, 1, a, rows, b, rows, singular, -1,
			      &rank);
	for (int k = 0; k < columns; k++)
		x[k] = info ? 0 : b[k] / length[k];
	return !info && singular[0] > 0 ? singular[columns - 1] / singular[0] : 0;
}

double linear_null(double *a, int rows, int columns, double *x)
{
	double v[LINEAR_SMALL_MAX * LINEAR_SMALL_MAX], singular[LINEAR_SMALL_MAX];

	if (linear_decompose(a, rows, columns, singular, v))
		return 0;
	memcpy(x, v + (columns - 1) * columns, (size_t)columns * sizeof(*x));
	return singular[0] > 0 ? singular[columns - 2] / singular[0] : 0;
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
	double *v = calloc(square + 2 * (size_t)n, sizeof(*v)), *length, *singular, least;
	int err;

	if (!v)
		return -ENOMEM;
	length = v + square;
	singular = length + n;
	linear_scale(task->jacobian, task->rows, n, length);
	err = linear_decompose(task->jacobian, task->rows, n, singular, v);
	if (!err) {
		least = task->rounding * singular[0];
		name_worst(v + (size_t)(n - 1) * (size_t)n, n, worst);
		assemble_covariance(v, singular, least, length, n, inverse);
		*condition = singular[n - 1] > least ? pow(singular[0] / singular[n - 1], 2)
						     : INFINITY;
		err = isinf(*condition) ? -ERANGE : 0;
	}
	free(v);
	return err;
}
