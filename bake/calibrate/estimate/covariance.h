/* SPDX-License-Identifier: MIT */
/*
 * (J^T J)^-1 without forming J^T J, which would halve the digits: columns are scaled to unit
 * length, then QR by Householder reflections, then singular values of R by one-sided Jacobi
 * rotations.
 */
#ifndef INLAY_BAKE_CALIBRATE_ESTIMATE_COVARIANCE_H
#define INLAY_BAKE_CALIBRATE_ESTIMATE_COVARIANCE_H

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
