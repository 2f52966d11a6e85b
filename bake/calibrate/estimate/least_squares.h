/* SPDX-License-Identifier: MIT */
/*
 * Nonlinear least squares by Levenberg and Marquardt (cminpack's lmder), with an optional robust
 * loss and the covariance of the solution.
 */
#ifndef INLAY_BAKE_CALIBRATE_ESTIMATE_LEAST_SQUARES_H
#define INLAY_BAKE_CALIBRATE_ESTIMATE_LEAST_SQUARES_H

#include <stdbool.h>

#include "hal/base/fault.h"

/*
 * Deviations by view. Errors of one picture go together (a bent board, the corner detector, its
 * light), so views count as independent, not their points.
 *
 * In coordinates in which the covariance of the shared unknowns would be sigma^2 I if points were
 * independent, view v pulls the solution by z_v = Q_v^T r_v, where Q is an orthonormal basis of the
 * shared columns of J without what the poses explain, and r the residuals. Then
 *     Z = sum of z'_v z'_v^T,   z'_v = (I - Q_v^T Q_v)^-1/2 z_v
 * is their covariance, without bias where points are independent after all (Bell and McCaffrey
 * 2002, CR2). As few views scatter, Z is drawn towards its diagonal by the share rho that Chen,
 * Wiesel and Hero 2010 (OAS) give for its mean m: towards m I, what bent boards do to some unknowns
 * would be declared of all. With no more views than unknowns the diagonal is too uncertain, and is
 * drawn towards m, too. A pose has the lens's covariance and m (B^T B)^-1 of its own.
 */

/* How rows and parameters belong to views. The first parameters are shared by all views; each view
 * then has as many of its own. */
struct by_view_layout {
	int views, shared, of_view;
	/* Finds the group at which a view's residuals begin; of view `views`: their number. */
	int (*first)(const void *context, int view);
};

struct by_view_task {
	const struct by_view_layout *layout;
	const void *context; /* of its functions */
	int rows, columns, group;
	const int *parameter;	/* [columns]: rising */
	const double *jacobian; /* [columns][rows], weighted */
	const double *residual; /* [rows], weighted */
};

struct by_view {
	/* with more residuals than unknowns of their own; below 2 nothing else is found */
	int views;
	int shared;	/* columns */
	double mean;	/* m; sigma^2 where points are independent */
	double *excess; /* [shared][shared]: R^T (shrunk Z - m I) R, for J = Q R */
};

/* Fills found. Returns 0; -ENOMEM. */
int by_view_find(const struct by_view_task *task, struct by_view *found);
void by_view_free(struct by_view *found);

/* covariance[columns][columns] = mean (J^T J)^-1 and what differs from that by direction, from
 * inverse[columns][columns] = (J^T J)^-1. */
void by_view_spread(const struct by_view *found, double mean, const double *inverse, int columns,
		    double *covariance);

struct least_squares {
	int parameters; /* length of x */
	int residuals;	/* scalars; at least as many as free parameters */
	/* Computes the residuals at x. False: x has none (a point behind the camera, a model folded
	 * over); the step is rejected and a shorter one is tried. NaN counts as false. */
	bool (*evaluate)(void *context, const double *x, double *residual);
	/*
	 * Optional Jacobian d residual / d x, [residuals][parameters], zeroed beforehand; called
	 * only where evaluate() succeeds. NULL: central differences with steps of scale *
	 * cbrt(epsilon), one-sided where evaluate() fails on the other side.
	 */
	void (*differentiate)(void *context, const double *x, double *jacobian);
	void *context;
	const double *scale;	 /* [parameters]: typical change of each, > 0 */
	const bool *fixed;	 /* [parameters]; NULL: all are free */
	const char *const *name; /* [parameters], for messages; NULL: they are numbered from 1 */
	/*
	 * Cauchy's robust loss, by iteratively reweighted least squares. Residuals in groups (2: x
	 * and y of a point) share one weight:
	 *     w = 1 / (1 + r^2 / c^2),   c = loss_scale * sigma
	 * where r is the length of the group and sigma a robust estimate from the median of the
	 * lengths. 0: plain squares, all weights 1.
	 */
	double loss_scale;
	int group; /* >= 1; residuals is a multiple of it */
	/* Views whose residuals go together; NULL: all groups are independent. Its functions get
	 * the context. */
	const struct by_view_layout *layout;
};

struct least_squares_fit {
	/*
	 * [parameters][parameters]; 0 for fixed ones. With plain squares
	 *     covariance = sigma^2 (J^T W J)^-1
	 * With a robust loss it is multiplied by
	 *     mean(w) mean(psi^2) / (sigma mean(psi'))^2
	 * over the inliers, the price of reweighting (Huber, Robust Statistics, 7.6). With a
	 * layout of two views or more it is by view (struct by_view), with at least that variance.
	 */
	double *covariance;
	/* [parameters][parameters], (J^T W J)^-1 alone, for callers with their own sigma */
	double *inverse;
	double *weight;	  /* [residuals / group], 0..1 */
	double *residual; /* [residuals], at the solution, unweighted */
	/* standard deviation of one residual, from the unweighted residuals of the inliers (weight
	 * >= 0.1); 0 without degrees of freedom */
	double sigma;
	double squares;	  /* sum of weighted squares */
	double condition; /* condition of J^T W J, columns scaled to unit length; 1 is best */
	/* If views > 1, what the views' differences tell; at least 1: by how much deviations by
	 * view are larger than by points, in the mean over the lens's unknowns. */
	struct by_view by_view;
	double dispersion;
	int freedom; /* residuals of the inliers less free parameters */
	int iterations;
};

/*
 * Minimises the squares; x is the first guess and becomes the solution. Returns 0; -ERANGE: the
 * parameters cannot be told apart (rank-deficient to rounding; fit is filled as far as possible,
 * and the variances of the parameters that the fault names are infinite); -EDOM: no residuals at
 * the first guess, or NaN; -ETIMEDOUT: no convergence within 500 iterations (fit is filled);
 * -EINVAL: fewer residuals than parameters; -ENOMEM.
 */
int least_squares_solve(const struct least_squares *problem, double *x,
			struct least_squares_fit *fit, struct fault *fault);
void least_squares_free(struct least_squares_fit *fit); /* idempotent; zeroed is fine */

#endif
