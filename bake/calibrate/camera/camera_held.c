/* SPDX-License-Identifier: MIT */
/*
 * Covariance from held unknowns. A centre or an s that is held is not exact, and its error moves
 * everything found with it: above all the translation along the picture; an error of s moves the
 * tilt, and with it f.
 *
 * To first order, the least-squares solution y changes with the held c by
 *     dy/dc = -(Jy^T W Jy)^-1 Jy^T W Jc
 * and its covariance grows by
 *     (dy/dc) var(c) (dy/dc)^T
 */
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "bake/calibrate/camera/camera_parts.h"

/* Computes d x / d x[held] of all unknowns; 1 for itself, 0 for other held ones. */
static void answer_to_held(const struct camera_private *own, const double *jacobian, int held,
			   double *by)
{
	const int n = problem_unknowns(&own->problem);

	for (int a = 0; a < n; a++)
		by[a] = a == held;
	for (int b = 0; b < n; b++) {
		double together = 0;

		if (own->fixed[b])
			continue;
		for (int i = 0; i < 2 * own->problem.count; i++)
			together += own->fit.weight[i / 2] * jacobian[i * n + b] *
				    jacobian[i * n + held];
		for (int a = 0; a < n; a++)
			by[a] -= own->fixed[a] ? 0 : own->fit.inverse[a * n + b] * together;
	}
}

/* Adds the covariance from one held unknown with standard deviation sigma; by is scratch space. */
static void hold_unknown(const struct camera_private *own, const double *jacobian, int unknown,
			 double sigma, double *by, double *held)
{
	const size_t n = (size_t)problem_unknowns(&own->problem);

	if (!own->fixed[unknown] || !(sigma > 0))
		return;
	answer_to_held(own, jacobian, unknown, by);
	for (size_t a = 0; a < n; a++)
		for (size_t b = 0; b < n; b++)
			held[a * n + b] += sigma * sigma * by[a] * by[b];
}

int camera_hold(struct camera_private *own)
{
	const size_t n = (size_t)problem_unknowns(&own->problem);
	double *jacobian, *by;

	/* where the points leave more open than that, nothing is known anyway */
	if (own->fit_error == -ERANGE)
		return 0;
	jacobian = calloc(2 * (size_t)own->problem.count * n, sizeof(*jacobian));
	by = calloc(n, sizeof(*by));
	if (jacobian && by) {
		problem_slopes(&own->problem, own->x, jacobian);
		for (int k = 0; k < 2; k++)
			hold_unknown(own, jacobian, MODEL_CENTRE_X + k,
				     own->guess.centre_deviation[k], by, own->uncertainty.held);
		hold_unknown(own, jacobian, MODEL_ASPECT, own->guess.aspect_deviation, by,
			     own->uncertainty.held_aspect);
	}
	free(jacobian);
	free(by);
	return jacobian && by ? 0 : -ENOMEM;
}
