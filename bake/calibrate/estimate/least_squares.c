/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/estimate/least_squares.h"

#include <cminpack.h>
#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/estimate/linear.h"
#include "bake/calibrate/estimate/order.h"

#define EVALUATIONS_MAX 500
#define WEIGHTINGS_MAX 50
/* largest change of a weight at which reweighting stops: it moves nothing by more than 1e-3 of its
 * deviation */
#define WEIGHTS_SETTLED 1e-4
/* larger changes: the next descent moves again, so this one may be rough */
#define WEIGHTS_MOVE 0.03
#define OUTLIER_WEIGHT 0.1
/* Relative change of the sum of squares at which a descent stops. Parameters are then right to 1e-6
 * of their deviations; a problem without noise gains ten decades a step until rounding ends it. */
#define TOLERANCE 1e-14
#define ROUGHLY 1e-4
/* Residual that makes lmder reject a step: larger than any real one. */
#define NO_RESIDUAL 1e100

/* Context of lmder's callback. lmder's unknowns are the distances of the free parameters from base,
 * in units of their scales. */
struct descent {
	const struct least_squares *problem;
	int columns;		     /* free parameters */
	int *parameter;		     /* [columns]: index of each free parameter */
	double *base, *x;	     /* [parameters] */
	double *root;		     /* [groups]: square roots of the weights */
	double *dense;		     /* [residuals][parameters] */
	double *ahead, *behind;	     /* [residuals] */
	double *jacobian;	     /* [columns][residuals], as lmder expects it */
	double *residual;	     /* [residuals], weighted */
	double *lengths;	     /* [groups] */
	double *unknown, *for_lmder; /* [columns], [5 columns + residuals] */
	int *pivot;
};

static void descent_free(struct descent *work)
{
	free(work->parameter);
	free(work->base);
	free(work->x);
	free(work->root);
	free(work->dense);
	free(work->ahead);
	free(work->behind);
	free(work->jacobian);
	free(work->residual);
	free(work->lengths);
	free(work->unknown);
	free(work->for_lmder);
	free(work->pivot);
}

static int descent_create(struct descent *work, const struct least_squares *problem)
{
	const size_t n = (size_t)problem->parameters, m = (size_t)problem->residuals;
	const size_t groups = m / (size_t)problem->group;

	*work = (struct descent){.problem = problem};
	work->parameter = calloc(n, sizeof(*work->parameter));
	work->base = calloc(n, sizeof(double));
	work->x = calloc(n, sizeof(double));
	work->root = calloc(groups, sizeof(double));
	work->dense = calloc(n * m, sizeof(double));
	work->ahead = calloc(m, sizeof(double));
	work->behind = calloc(m, sizeof(double));
	work->jacobian = calloc(n * m, sizeof(double));
	work->residual = calloc(m, sizeof(double));
	work->lengths = calloc(groups, sizeof(double));
	work->unknown = calloc(n, sizeof(double));
	work->for_lmder = calloc(5 * n + m, sizeof(double));
	work->pivot = calloc(n, sizeof(*work->pivot));
	if (!work->parameter || !work->base || !work->x || !work->root || !work->dense ||
	    !work->ahead || !work->behind || !work->jacobian || !work->residual || !work->lengths ||
	    !work->unknown || !work->for_lmder || !work->pivot) {
		descent_free(work);
		return -ENOMEM;
	}
	for (int k = 0; k < problem->parameters; k++)
		if (!problem->fixed || !problem->fixed[k])
			work->parameter[work->columns++] = k;
	return 0;
}

static bool descent_evaluate(const struct descent *work, const double *x, double *residual)
{
	const struct least_squares *problem = work->problem;

	if (!problem->evaluate(problem->context, x, residual))
		return false;
	for (int i = 0; i < problem->residuals; i++)
		if (!(fabs(residual[i]) < NO_RESIDUAL))
			return false;
	return true;
}

static void descent_difference(struct descent *work, double *x)
{
	const struct least_squares *problem = work->problem;
	const int n = problem->parameters;

	for (int j = 0; j < work->columns; j++) {
		const int k = work->parameter[j];
		const double here = x[k], step = problem->scale[k] * cbrt(DBL_EPSILON);
		/* The step that was really made: adding to a large x rounds. */
		volatile double above = here + step, below = here - step;
		bool ahead, behind;

		x[k] = above;
		ahead = descent_evaluate(work, x, work->ahead);
		x[k] = below;
		behind = descent_evaluate(work, x, work->behind);
		x[k] = here;
		if (!ahead && !behind)
			continue;
		if (!ahead) {
			descent_evaluate(work, x, work->ahead);
			above = here;
		} else if (!behind) {
			descent_evaluate(work, x, work->behind);
			below = here;
		}
		for (int i = 0; i < problem->residuals; i++)
			work->dense[i * n + k] = (work->ahead[i] - work->behind[i]) /
						 (above - below);
	}
}

/* Computes the weighted Jacobian of the free parameters, in units of their scales. */
static void descent_differentiate(struct descent *work, double *x, double *jacobian)
{
	const struct least_squares *problem = work->problem;
	const int n = problem->parameters, m = problem->residuals;

	memset(work->dense, 0, (size_t)n * (size_t)m * sizeof(*work->dense));
	if (problem->differentiate)
		problem->differentiate(problem->context, x, work->dense);
	else
		descent_difference(work, x);
	for (int j = 0; j < work->columns; j++) {
		const int k = work->parameter[j];

		for (int i = 0; i < m; i++)
			jacobian[(size_t)j * (size_t)m + (size_t)i] =
				work->dense[i * n + k] * problem->scale[k] *
				work->root[i / problem->group];
	}
}

static int minpack_calls(void *context, int m, int n, const double *unknown, double *residual,
			 double *jacobian, int stride, int what)
{
	struct descent *work = context;
	const struct least_squares *problem = work->problem;

	(void)stride; /* equals m */
	for (int j = 0; j < n; j++) {
		const int k = work->parameter[j];

		work->x[k] = work->base[k] + problem->scale[k] * unknown[j];
	}
	if (what == 2) {
		descent_differentiate(work, work->x, jacobian);
		return 0;
	}
	if (descent_evaluate(work, work->x, residual))
		for (int i = 0; i < m; i++)
			residual[i] *= work->root[i / problem->group];
	else
		for (int i = 0; i < m; i++)
			residual[i] = NO_RESIDUAL;
	return 0;
}

/* One descent from base at fixed weights; base becomes the solution. */
static int descent_run(struct descent *work, double tolerance, int *iterations)
{
	const struct least_squares *problem = work->problem;
	const int n = work->columns, m = problem->residuals;
	double *wa = work->for_lmder;
	double *unknown = work->unknown;
	int evaluations = 0, derivatives = 0, info;

	memcpy(work->x, work->base, (size_t)problem->parameters * sizeof(*work->x));
	memset(unknown, 0, (size_t)n * sizeof(*unknown));
	info = lmder(minpack_calls, work, m, n, unknown, work->residual, work->jacobian, m,
		     tolerance, tolerance, 0, EVALUATIONS_MAX, wa, 1, 100, 0, &evaluations,
		     &derivatives, work->pivot, wa + n, wa + 2 * n, wa + 3 * n, wa + 4 * n,
		     wa + 5 * n);
	*iterations += derivatives;
	for (int j = 0; j < n; j++)
		work->base[work->parameter[j]] += problem->scale[work->parameter[j]] * unknown[j];
	return info == 5 ? -ETIMEDOUT : 0;
}

static double group_length(const struct descent *work, const double *residual, int g)
{
	double squares = 0;

	for (int i = 0; i < work->problem->group; i++) {
		const double r = residual[g * work->problem->group + i];

		squares += r * r;
	}
	return sqrt(squares);
}

/* Returns the c of the loss: loss_scale times sigma. sigma follows from the median length, which is
 * that of a chi distribution with as many degrees of freedom as a group has members (Wilson and
 * Hilferty), corrected for the degrees of freedom that the fit took. */
static double loss_width(const struct descent *work, const double *residual)
{
	const struct least_squares *problem = work->problem;
	const int groups = problem->residuals / problem->group;
	const double size = problem->group, median_of_one = sqrt(size * pow(1 - 2 / (9 * size), 3));
	const int freedom = problem->residuals - work->columns;
	double sigma;

	for (int g = 0; g < groups; g++)
		work->lengths[g] = group_length(work, residual, g);
	qsort(work->lengths, (size_t)groups, sizeof(*work->lengths), order_doubles);
	sigma = work->lengths[groups / 2] / median_of_one *
		sqrt((double)problem->residuals / (freedom > 0 ? freedom : 1));
	/* Where most points fit to rounding, rounding errors must not decide which are outliers. */
	return problem->loss_scale * fmax(sigma, 1e-9 * work->lengths[groups - 1]);
}

/* Computes new weights; returns the largest change of a weight. */
static double descent_reweight(struct descent *work, const double *residual, double *width)
{
	const int groups = work->problem->residuals / work->problem->group;
	double most = 0;

	*width = loss_width(work, residual);
	for (int g = 0; g < groups; g++) {
		const double r = group_length(work, residual, g);
		const double weight = *width > 0 ? 1 / (1 + r * r / (*width * *width)) : 1;
		const double was = work->root[g] * work->root[g];

		most = fmax(most, fabs(weight - was));
		work->root[g] = sqrt(weight);
	}
	return most;
}

/* Fills squares, sigma and freedom; returns the factor of (J^T W J)^-1 in the covariance. stretch:
 * the loss's mean weight over its mean slope, by which steps are longer than plain squares say. */
static double residual_spread(const struct descent *work, double width,
			      struct least_squares_fit *fit, double *stretch)
{
	const struct least_squares *problem = work->problem;
	const int groups = problem->residuals / problem->group;
	double squares = 0, weights = 0, psi_squares = 0, slope = 0;
	int inliers = 0;

	for (int g = 0; g < groups; g++) {
		const double r = group_length(work, fit->residual, g), w = fit->weight[g];

		fit->squares += w * r * r;
		if (w < OUTLIER_WEIGHT)
			continue;
		inliers++;
		squares += r * r;
		weights += w;
		psi_squares += w * w * r * r;
		slope += w - (width > 0 ? 2 * w * w * r * r / (problem->group * width * width) : 0);
	}
	fit->freedom = inliers * problem->group - work->columns;
	*stretch = problem->loss_scale > 0 ? weights / slope : 1;
	if (fit->freedom <= 0)
		return 0;
	fit->sigma = sqrt(squares / fit->freedom);
	if (problem->loss_scale > 0 && squares > 0) /* mean(psi^2) / sigma^2, both from the data */
		return fit->sigma * fit->sigma * (weights / inliers) * (psi_squares / squares) /
		       ((slope / inliers) * (slope / inliers));
	return fit->sigma * fit->sigma;
}

/* Computes what the views' differences tell, from the weighted Jacobian. */
static int fit_compare_views(struct descent *work, struct least_squares_fit *fit)
{
	const struct least_squares *problem = work->problem;
	const struct by_view_task task = {.layout = problem->layout,
					  .context = problem->context,
					  .rows = problem->residuals,
					  .columns = work->columns,
					  .group = problem->group,
					  .parameter = work->parameter,
					  .jacobian = work->jacobian,
					  .residual = work->residual};

	if (!problem->layout || fit->freedom <= 0)
		return 0;
	for (int i = 0; i < problem->residuals; i++)
		work->residual[i] = fit->residual[i] * work->root[i / problem->group];
	return by_view_find(&task, &fit->by_view);
}

/* Fills the covariance from small[columns][columns] = (J^T W J)^-1; some may be infinite. */
static int fit_spread(struct descent *work, double variance, double stretch,
		      struct least_squares_fit *fit, const double *small, bool known)
{
	const struct least_squares *problem = work->problem;
	const size_t columns = (size_t)work->columns;
	const double longer = stretch * stretch;
	const int n = problem->parameters;
	double *spread = calloc(columns * columns, sizeof(*spread));

	if (!spread)
		return -ENOMEM;
	fit->dispersion = 1;
	if (!known || fit->by_view.views < 2) {
		for (size_t k = 0; k < columns * columns; k++)
			spread[k] = isinf(small[k]) ? small[k] : variance * small[k];
	} else {
		const double mean = fmax(fit->by_view.mean, variance / longer);

		fit->dispersion = variance > 0 ? sqrt(mean * longer / variance) : 1;
		by_view_spread(&fit->by_view, mean, small, work->columns, spread);
		for (size_t k = 0; k < columns * columns; k++)
			spread[k] *= longer;
	}
	for (int a = 0; a < work->columns; a++)
		for (int b = 0; b < work->columns; b++) {
			const int i = work->parameter[a], j = work->parameter[b];
			const double units = problem->scale[i] * problem->scale[j];

			fit->inverse[i * n + j] = small[a * work->columns + b] * units;
			fit->covariance[i * n + j] = spread[a * work->columns + b] * units;
		}
	free(spread);
	return 0;
}

static int fit_fill(struct descent *work, double width, struct least_squares_fit *fit,
		    struct fault *fault)
{
	const struct least_squares *problem = work->problem;
	const int n = problem->parameters;
	const struct covariance_task task = {
		.rows = problem->residuals,
		.columns = work->columns,
		.jacobian = work->jacobian,
		/* relative accuracy of the derivatives */
		.rounding = problem->differentiate ? 1e-13 : 1e-10,
	};
	double *small = work->dense;
	double variance, stretch = 1;
	int err, worst[2];

	memcpy(work->x, work->base, (size_t)n * sizeof(*work->x));
	descent_evaluate(work, work->x, fit->residual);
	for (int g = 0; g < problem->residuals / problem->group; g++)
		fit->weight[g] = work->root[g] * work->root[g];
	variance = residual_spread(work, width, fit, &stretch);
	descent_differentiate(work, work->x, work->jacobian);
	err = fit_compare_views(work, fit);
	if (!err)
		err = covariance_find(&task, small, &fit->condition, worst);
	if ((err && err != -ERANGE) || fit_spread(work, variance, stretch, fit, small, !err))
		return err ? err : -ENOMEM;
	if (err && problem->name)
		fault_say(fault, err, "what was observed does not tell %s from %s",
			  problem->name[work->parameter[worst[0]]],
			  problem->name[work->parameter[worst[1]]]);
	else if (err)
		fault_say(fault, err,
			  "what was observed does not tell parameter %d from parameter %d",
			  work->parameter[worst[0]] + 1, work->parameter[worst[1]] + 1);
	return err;
}

static int fit_solve(struct descent *work, double *x, struct least_squares_fit *fit,
		     struct fault *fault)
{
	const struct least_squares *problem = work->problem;
	const size_t bytes = (size_t)problem->parameters * sizeof(*x);
	double width = 0;
	int err, late = 0;

	memcpy(work->base, x, bytes);
	for (int g = 0; g < problem->residuals / problem->group; g++)
		work->root[g] = 1;
	if (!descent_evaluate(work, x, fit->residual))
		return fault_say(fault, -EDOM, "the first guess does not see every point");
	/* A robust fit uses weights from the first guess on: plain squares would follow the
	 * outliers away from a good guess. */
	if (!(problem->loss_scale > 0))
		late = descent_run(work, TOLERANCE, &fit->iterations);
	for (int k = 0; problem->loss_scale > 0 && k < WEIGHTINGS_MAX; k++) {
		double change;

		descent_evaluate(work, work->base, fit->residual);
		change = descent_reweight(work, fit->residual, &width);
		if (change < WEIGHTS_SETTLED)
			break;
		late = descent_run(work, change < WEIGHTS_MOVE ? TOLERANCE : ROUGHLY,
				   &fit->iterations);
	}
	err = fit_fill(work, width, fit, fault);
	memcpy(x, work->base, bytes);
	if (!err && late)
		err = fault_say(fault, late, "no solution after %d iterations", fit->iterations);
	return err;
}

int least_squares_solve(const struct least_squares *problem, double *x,
			struct least_squares_fit *fit, struct fault *fault)
{
	const size_t n = (size_t)problem->parameters, m = (size_t)problem->residuals;
	struct descent work;
	int err;

	*fit = (struct least_squares_fit){0};
	if (problem->group < 1 || problem->residuals % problem->group || problem->parameters < 1 ||
	    problem->residuals < 1)
		return fault_say(fault, -EINVAL, "%d numbers in groups of %d, %d parameters",
				 problem->residuals, problem->group, problem->parameters);
	err = descent_create(&work, problem);
	if (err)
		return fault_say(fault, err, "out of memory");
	fit->covariance = calloc(n * n, sizeof(*fit->covariance));
	fit->inverse = calloc(n * n, sizeof(*fit->inverse));
	fit->weight = calloc(m / (size_t)problem->group, sizeof(*fit->weight));
	fit->residual = calloc(m, sizeof(*fit->residual));
	if (!fit->covariance || !fit->inverse || !fit->weight || !fit->residual)
		err = fault_say(fault, -ENOMEM, "out of memory");
	else if (work.columns < 1 || work.columns > problem->residuals)
		err = fault_say(fault, -EINVAL, "%d numbers observed, %d parameters to find",
				problem->residuals, work.columns);
	else
		err = fit_solve(&work, x, fit, fault);
	descent_free(&work);
	return err;
}

void least_squares_free(struct least_squares_fit *fit)
{
	free(fit->covariance);
	free(fit->inverse);
	free(fit->weight);
	free(fit->residual);
	by_view_free(&fit->by_view);
	*fit = (struct least_squares_fit){0};
}
