/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/estimate/covariance.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "bake/calibrate/estimate/linear.h"

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
