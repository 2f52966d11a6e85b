/* SPDX-License-Identifier: MIT */
/*
 * Nonlinear least squares by Levenberg and Marquardt (cminpack's lmder), with an optional robust
 * loss and the covariance of what is found.
 */
#ifndef INLAY_BAKE_CALIBRATE_ESTIMATE_LEAST_SQUARES_H
#define INLAY_BAKE_CALIBRATE_ESTIMATE_LEAST_SQUARES_H

#include <stdbool.h>

#include "hal/base/fault.h"

struct least_squares {
	int parameters; /* length of x */
	int residuals;	/* single numbers; at least as many as free parameters */
	/* Residuals at x. False: x has none (a point behind the camera, a model folded over): the
	 * step is rejected and a shorter one is tried. NaN counts as false. */
	bool (*evaluate)(void *context, const double *x, double *residual);
	/*
	 * Optional: d residual / d x, [residuals][parameters], zeroed beforehand; only called where
	 * evaluate() gives residuals. NULL: central differences with steps of scale * cbrt(epsilon)
	 * (from one side where the other has no residuals).
	 */
	void (*differentiate)(void *context, const double *x, double *jacobian);
	void *context;
	const double *scale;	 /* [parameters]: a typical change of each, > 0 */
	const bool *fixed;	 /* [parameters]; NULL: all are free */
	const char *const *name; /* [parameters], for faults; NULL: they are counted from 1 */
	/*
	 * Robust: residuals in groups (2: a point's x and y) share a weight 1 / (1 + r^2 / c^2) of
	 * their length r (Cauchy's loss), found by repeated weighting; c = loss_scale times a
	 * robust estimate of sigma (median of lengths). 0: plain squares, all weights 1.
	 */
	double loss_scale;
	int group; /* >= 1; residuals is a multiple of it */
	/* The first guess is the solution, found in another way: only say how well it is known. */
	bool stay;
};

struct least_squares_fit {
	/*
	 * [parameters][parameters], sigma^2 (J^T W J)^-1; 0 for fixed. With a robust loss times
	 * mean(w) mean(psi^2) / (sigma mean(psi'))^2 over the inliers, what repeated weighting
	 * costs (Huber, Robust Statistics, 7.6).
	 */
	double *covariance;
	double *inverse;  /* [parameters][parameters], (J^T W J)^-1 alone: where sigma is not known,
			     or too good to be true */
	double *weight;	  /* [residuals / group], 0..1 */
	double *residual; /* [residuals] at the solution, unweighted */
	double sigma;	  /* of one residual, from the inliers' (weight >= 0.1) unweighted
			     residuals; 0 without degrees of freedom */
	double squares;	  /* sum of weighted squares */
	double condition; /* of J^T W J, columns scaled to unit length; 1 is best */
	int freedom;	  /* the inliers' residuals less free parameters */
	int iterations;
};

/*
 * x is the first guess and becomes the solution. 0; -ERANGE: the parameters cannot be told apart
 * (rank-deficient to rounding; fit is filled as far as possible, with infinite variances of those
 * that the fault names); -EDOM: no residuals at the first guess, or NaN; -ETIMEDOUT: not converged
 * within 500 iterations (fit is filled); -EINVAL: fewer residuals than parameters; -ENOMEM.
 */
int least_squares_solve(const struct least_squares *problem, double *x,
			struct least_squares_fit *fit, struct fault *fault);
void least_squares_free(struct least_squares_fit *fit); /* idempotent; zeroed is fine */

#endif
