/* SPDX-License-Identifier: MIT */
/*
 * (J^T J)^-1 without forming J^T J, which would halve the digits: columns scaled to unit length,
 * QR by Householder's reflections, then singular values of R by one-sided Jacobi rotations.
 */
#ifndef INLAY_BAKE_CALIBRATE_ESTIMATE_COVARIANCE_H
#define INLAY_BAKE_CALIBRATE_ESTIMATE_COVARIANCE_H

struct covariance_task {
	int rows, columns; /* rows >= columns >= 1 */
	double *jacobian;  /* [columns][rows]: a column's numbers follow each other; destroyed */
	double rounding;   /* how well they are known, of the columns' lengths */
};

/*
 * inverse: [columns][columns]. condition: of J^T J after scaling, 1 or more. 0; -ERANGE: some
 * directions are below rounding: condition is infinite, so are the variances of all that take part
 * in them, and worst names the two that take the largest part (the same twice: one alone has no
 * influence); -ENOMEM.
 */
int covariance_find(const struct covariance_task *task, double *inverse, double *condition,
		    int worst[2]);

#endif
