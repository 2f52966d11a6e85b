/* SPDX-License-Identifier: MIT */
/*
 * Small dense systems by QR and singular values. Matrices are columns one after the other,
 * a[column][row], and are destroyed.
 */
#ifndef INLAY_BAKE_CALIBRATE_ESTIMATE_LINEAR_H
#define INLAY_BAKE_CALIBRATE_ESTIMATE_LINEAR_H

#define LINEAR_SMALL_MAX 12 /* columns of linear_solve() and linear_null() */

/*
 * The first kept columns become triangular by Householder's reflections, which the others undergo
 * too: r[columns][kept] holds the first kept rows of Q^T A. rows >= kept.
 */
void linear_triangulate(double *a, int rows, int columns, int kept, double *r);

/*
 * Singular values of r[n][n] by one-sided Jacobi rotations: R V = U S, whose columns r becomes
 * (their lengths are the singular values); v[n][n] is V, its columns one after the other.
 */
void linear_diagonalize(double *r, double *v, int n);

/* Columns to unit length; length gets what they had, 1 for those that are 0. */
void linear_scale(double *a, int rows, int columns, double *length);

/*
 * x[columns] that brings A x nearest to b, which is a's column after the last. rows >= columns.
 * Returns the smallest singular value over the largest, columns scaled: 0 where x is not unique.
 */
double linear_solve(double *a, int rows, int columns, double *x);

/*
 * The unit x[columns] for which |A x| is least. rows >= columns (fill with rows of 0).
 * Returns the second smallest over the largest: 0 where x is
 * not unique.
 */
double linear_null(double *a, int rows, int columns, double *x);

#endif
