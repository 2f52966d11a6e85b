/* SPDX-License-Identifier: MIT */
/*
 * Small dense linear systems by QR and singular values. Matrices are column-major, a[column][row];
 * the functions overwrite them.
 */
#ifndef INLAY_BAKE_CALIBRATE_ESTIMATE_LINEAR_H
#define INLAY_BAKE_CALIBRATE_ESTIMATE_LINEAR_H

#define LINEAR_SMALL_MAX 12 /* most columns of linear_solve() and linear_null() */

/*
 * QR by Householder reflections: the first kept columns become triangular, the others are
 * transformed too. r[columns][kept] receives the first kept rows of Q^T A. rows >= kept.
 */
void linear_triangulate(double *a, int rows, int columns, int kept, double *r);

/*
 * Singular value decomposition of r[n][n] by one-sided Jacobi rotations:
 *     R V = U S
 * r becomes U S, so the lengths of its columns are the singular values; v[n][n] becomes V.
 */
void linear_diagonalize(double *r, double *v, int n);

/* Scales columns to unit length. length[columns] receives the old lengths, 1 for columns of
 * zeros. */
void linear_scale(double *a, int rows, int columns, double *length);

/*
 * Linear least squares: x[columns] minimises |A x - b|, where b is the column of a after the last.
 * rows >= columns. Returns the smallest singular value over the largest, columns scaled to unit
 * length: 0 where x is not unique.
 */
double linear_solve(double *a, int rows, int columns, double *x);

/*
 * Finds the unit vector x[columns] that minimises |A x|. rows >= columns (fill with rows of 0).
 * Returns the second smallest singular value over the largest: 0 where x is not unique.
 */
double linear_null(double *a, int rows, int columns, double *x);

/*
 * (J^T J)^-1 without forming J^T J, which would halve the digits: columns are scaled to unit
 * length, then QR by Householder reflections, then singular values of R by one-sided Jacobi
 * rotations.
 */

struct covariance_task {
	int rows, columns; /* rows >= columns >= 1 */
	double *jacobian;  /* [columns][rows], column-major; overwritten */
	double rounding;   /* relative error of the Jacobian, in units of the columns' lengths */
};

/*
 * Computes inverse[columns][columns] = (J^T J)^-1. condition is that of J^T J after scaling, 1 or
 * more. Returns 0; -ENOMEM; -ERANGE: some directions are below rounding. Then condition is
 * infinite, the variances of all parameters in these directions are infinite, and worst holds the
 * two parameters with the largest part in the weakest direction (the same one twice: a parameter
 * without influence).
 */
int covariance_find(const struct covariance_task *task, double *inverse, double *condition,
		    int worst[2]);

#endif
