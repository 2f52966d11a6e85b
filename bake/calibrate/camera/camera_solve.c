/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/camera/camera_parts.h"
#include "bake/calibrate/camera/camera_problem.h"
#include "bake/calibrate/estimate/rotation.h"
#include "hal/optics/vec.h"

#define FEWEST_FULL 11 /* least points for a free centre */
/* As shares of the diagonal: the largest deviation of a found centre, and its largest distance from
 * the first guess. Beyond, it counts as lost and is held; so does a centre that the points
 * determine worse than the first guess is known. The same goes for s. */
#define CENTRE_LOST 0.15
#define CENTRE_FAR 0.3
#define ASPECT_LOST 0.05
/* Gain of more radial terms, in variances, that noise alone makes once in a thousand times (chi
 * squared of two terms), and the least number of points to look for it. */
#define RADIAL_GAIN 13.8
#define RADIAL_POINTS 40

static int solver_descend(struct camera_private *own, double *x, const bool *fixed)
{
	least_squares_free(&own->fit);
	return problem_descend(&own->problem, x, fixed, own->task.robust ? CAMERA_LOSS : 0,
			       &own->fit, &own->why);
}

static void hold_shared(const struct camera_private *own, bool centre, bool aspect, bool *fixed)
{
	const bool known = own->task.intrinsics;

	memset(fixed, 0, (size_t)problem_unknowns(&own->problem) * sizeof(*fixed));
	fixed[MODEL_FOCAL] = known;
	for (int k = 0; k < MODEL_RADIAL; k++)
		fixed[MODEL_KAPPA1 + k] = known || k >= own->radial;
	fixed[MODEL_CENTRE_X] = fixed[MODEL_CENTRE_Y] = known || centre;
	fixed[MODEL_ASPECT] = known || aspect;
	for (int v = 0; v < own->problem.views; v++)
		for (int k = 0; k < MODEL_OF_VIEW; k++)
			fixed[model_of_view(v) + k] = own->problem.first[v + 1] ==
						      own->problem.first[v];
}

/* Whether the residuals exceed the free unknowns by two or more degrees of freedom. */
static bool has_enough_points(const struct camera_private *own)
{
	int wanted = 2;

	for (int k = 0; k < problem_unknowns(&own->problem); k++)
		wanted += !own->fixed[k];
	return 2 * own->problem.count >= wanted;
}

/* Whether s can be determined: one plane does not, as any stretch of the picture looks like a tilt.
 * Two planes do if they are tilted well. */
static bool aspect_shows(const struct camera_private *own)
{
	int planes = 0;

	if (!(own->guess.aspect_deviation > 0))
		return false;
	for (int v = 0; v < own->problem.views; v++) {
		if (own->problem.first[v + 1] == own->problem.first[v])
			continue;
		if (!problem_flat(&own->problem, v))
			return true;
		planes++;
	}
	return planes > 1;
}

static double deviation_of(const struct camera_private *own, int unknown)
{
	return sqrt(own->fit.covariance[unknown * (problem_unknowns(&own->problem) + 1)]);
}

/* Whether the points determine s worse than it is known beforehand, without contradicting that. */
static bool aspect_lost(const struct camera_private *own, const double *x)
{
	const double told = deviation_of(own, MODEL_ASPECT), known = own->guess.aspect_deviation;

	if (!(told < ASPECT_LOST))
		return true;
	return told > known && fabs(x[MODEL_ASPECT] - own->guess.aspect) < 3 * hypot(told, known);
}

static bool centre_lost(const struct camera_private *own, const double *x)
{
	for (int k = 0; k < 2; k++)
		if (!(deviation_of(own, MODEL_CENTRE_X + k) <
		      fmin(own->guess.centre_deviation[k], CENTRE_LOST * own->diagonal)) ||
		    !(fabs(x[MODEL_CENTRE_X + k] - own->guess.centre[k]) <
		      CENTRE_FAR * own->diagonal))
			return true;
	return false;
}

/* Descends with the axis and s held; with more radial terms after kappa1 alone. */
static int solve_held(struct camera_private *own)
{
	const int radial = own->radial;
	int err = 0;

	for (own->radial = 1; err != -ENOMEM; own->radial = radial) {
		hold_shared(own, true, true, own->fixed);
		err = solver_descend(own, own->x, own->fixed);
		if (own->radial == radial)
			break;
	}
	own->radial = radial;
	return err;
}

/*
 * Finds f, the kappas and the poses first; then the centre, and s where it is observable. What is
 * not determined well enough is held at its first guess, and the rest found again; a centre that
 * was lost only because s was is tried again.
 */
static int solve_full(struct camera_private *own, double *tried)
{
	const size_t bytes = (size_t)problem_unknowns(&own->problem) * sizeof(*tried);
	const bool few = own->problem.count < FEWEST_FULL;
	bool centre = few, aspect = !aspect_shows(own);
	int err;

	err = solve_held(own);
	if (err == -ENOMEM || own->task.intrinsics || (centre && aspect))
		return err;
	for (;;) {
		memcpy(tried, own->x, bytes);
		hold_shared(own, centre, aspect, own->fixed);
		if (!has_enough_points(own)) {
			hold_shared(own, true, true, own->fixed);
			centre = aspect = true;
		}
		if (aspect)
			tried[MODEL_ASPECT] = own->guess.aspect;
		err = solver_descend(own, tried, own->fixed);
		if (err == -ENOMEM || (centre && aspect))
			break;
		if (!centre && (err == -ERANGE || centre_lost(own, tried))) {
			centre = true;
		} else if (!aspect && (err || aspect_lost(own, tried))) {
			aspect = true;
			centre = few;
		} else {
			break;
		}
	}
	memcpy(own->x, tried, bytes);
	return err;
}

/* Whether two solutions of a lone plane are the same: their normals are within a degree. */
static bool same_tilt(const struct camera_private *own, const double *a, const double *b)
{
	const double *axis = own->problem.shape[0].axes + 6;
	struct model_view view[2];
	double normal[2][3], across[3];

	model_turn(&view[0], a + MODEL_SHARED);
	model_turn(&view[1], b + MODEL_SHARED);
	for (int k = 0; k < 2; k++)
		mat_apply(view[k].rotation, axis, normal[k]);
	vec_cross(normal[0], normal[1], across);
	return vec_dot(normal[0], normal[1]) > 0 && vec_length(across) < 0.0175;
}

/* Tries a lone plane tilted the other way, which looks the same from afar. */
static int try_other_tilt(struct camera_private *own, double *other)
{
	const int n = problem_unknowns(&own->problem);
	const double rms = problem_rms(&own->problem, own->x);
	bool *pose_only = calloc((size_t)n, sizeof(*pose_only));
	int err;

	if (!pose_only)
		return -ENOMEM;
	for (int k = 0; k < MODEL_SHARED; k++)
		pose_only[k] = true;
	memcpy(other, own->x, (size_t)n * sizeof(*other));
	camera_tilt(&own->problem, 0, own->x, other + MODEL_SHARED);
	err = problem_descend(&own->problem, other, pose_only, own->task.robust ? CAMERA_LOSS : 0,
			      NULL, NULL);
	free(pose_only);
	if (err == -ENOMEM)
		return err;
	if (err == -EDOM || same_tilt(own, own->x, other))
		return 0;
	own->other_tilt = problem_rms(&own->problem, other);
	if (own->other_tilt < rms) {
		own->fit_error = solver_descend(own, other, own->fixed);
		own->other_tilt = rms;
		memcpy(own->x, other, (size_t)n * sizeof(*other));
		return own->fit_error == -ENOMEM ? -ENOMEM : 0;
	}
	return 0;
}

/* ---- all of one lens model ---- */

/* Solves from the first guess in x. */
static int solve_guessed(struct camera_private *own)
{
	double *tried = calloc((size_t)problem_unknowns(&own->problem), sizeof(*tried));
	int err;

	if (!tried)
		return -ENOMEM;
	own->fit_error = solve_full(own, tried);
	err = own->fit_error == -ENOMEM ? -ENOMEM : 0;
	if (!err && own->problem.views == 1 && problem_flat(&own->problem, 0) &&
	    own->fit_error != -EDOM)
		err = try_other_tilt(own, tried);
	free(tried);
	return err;
}

/* Whether there is a solution that found a lens in all ways. */
static bool finds_lens(const struct camera_private *own)
{
	return !own->task.intrinsics && !own->guess_error && !own->fit_error;
}

/* ---- radial terms ---- */

/* A solution that is set aside. */
struct kept_solution {
	double *x;
	bool *fixed;
	struct least_squares_fit fit;
	int radial, fit_error;
};

/* Exchanges the solution with the one that was set aside. */
static void exchange_solutions(struct camera_private *own, struct kept_solution *kept)
{
	const struct kept_solution now = {own->x, own->fixed, own->fit, own->radial,
					  own->fit_error};

	own->x = kept->x;
	own->fixed = kept->fixed;
	own->fit = kept->fit;
	own->radial = kept->radial;
	own->fit_error = kept->fit_error;
	*kept = now;
}

static double left_out_rms(const struct camera_left_out *out)
{
	double sum = 0;

	for (int k = 0; k < out->count; k++)
		sum += out->loss[k];
	return sqrt(sum / fmax(out->points, 1));
}

/* Solves with so many terms from the solution, and compares what both predict. *better: the new
 * solution is kept; else the old one is. */
static int try_radial(struct camera_private *own, int radial, double width, bool *better)
{
	const size_t n = (size_t)problem_unknowns(&own->problem);
	struct kept_solution kept = {
		.x = calloc(n, sizeof(double)), .fixed = calloc(n, sizeof(bool)), .radial = radial};
	struct camera_left_out out[2] = {{.loss = NULL}, {.loss = NULL}};
	double *tried = calloc(n, sizeof(*tried)), reach;
	int err = kept.x && kept.fixed && tried ? 0 : -ENOMEM;

	*better = false;
	if (!err)
		err = camera_leave_out(own, width, &out[0]);
	if (!err) {
		own->left_out[own->radial] = left_out_rms(&out[0]);
		memcpy(kept.x, own->x, n * sizeof(*kept.x));
		exchange_solutions(own, &kept);
		own->fit_error = solve_full(own, tried);
		err = own->fit_error == -ENOMEM ? -ENOMEM : 0;
		if (!err && !own->fit_error && camera_grows_to(own, &reach) > reach) {
			err = camera_leave_out(own, width, &out[1]);
			own->left_out[radial] = left_out_rms(&out[1]);
			*better = !err && camera_predicts_better(&out[0], &out[1],
								 RADIAL_GAIN * kept.fit.sigma *
									 kept.fit.sigma);
		}
		if (!*better)
			exchange_solutions(own, &kept);
	}
	free(kept.x);
	free(kept.fixed);
	least_squares_free(&kept.fit);
	free(tried);
	free(out[0].loss);
	free(out[1].loss);
	return err;
}

/*
 * Finds how many radial terms describe the lens (own->radial_wanted): those that predict best what
 * was left out. Trials are made only where the residuals show that more terms would fit better than
 * noise explains. Where the task says how many there are, its solution is kept.
 */
static int choose_radial(struct camera_private *own)
{
	const int given = own->task.radial;
	struct kept_solution first = {.radial = own->radial};
	const size_t n = (size_t)problem_unknowns(&own->problem);
	const double width = own->task.robust ? CAMERA_LOSS * own->fit.sigma : 0;
	double gain;
	int err = camera_radial_gain(own, &gain);

	own->radial_wanted = own->radial;
	if (err || !(gain > RADIAL_GAIN) || own->problem.count < RADIAL_POINTS)
		return err;
	first.x = calloc(n, sizeof(*first.x));
	first.fixed = calloc(n, sizeof(*first.fixed));
	if (!first.x || !first.fixed)
		err = -ENOMEM;
	if (!err) {
		memcpy(first.x, own->x, n * sizeof(*first.x));
		memcpy(first.fixed, own->fixed, n * sizeof(*first.fixed));
	}
	for (int radial = own->radial + 1; radial <= MODEL_RADIAL && !err; radial++) {
		bool better;

		err = try_radial(own, radial, width, &better);
	}
	own->radial_wanted = own->radial;
	if (!err && given && own->radial != given) {
		memcpy(own->x, first.x, n * sizeof(*first.x));
		memcpy(own->fixed, first.fixed, n * sizeof(*first.fixed));
		own->radial = given;
		own->fit_error = solver_descend(own, own->x, own->fixed);
		err = own->fit_error == -ENOMEM ? -ENOMEM : 0;
	}
	free(first.x);
	free(first.fixed);
	return err;
}

/* ---- all of it ---- */

/* Guesses and solves, with one radial term or those that are given, then with as many as predict
 * best. */
int camera_solve(struct camera_private *own)
{
	const struct tsai_camera *known = own->task.intrinsics;
	struct camera_start start = {.known = known};
	int err = 0;

	own->other_tilt = INFINITY;
	memset(own->left_out, 0, sizeof(own->left_out));
	own->radial = own->task.radial ? own->task.radial : 1;
	start.shared[MODEL_FOCAL] = known ? known->focal : 1;
	start.shared[MODEL_KAPPA1] = known ? known->kappa1 : 0;
	start.shared[MODEL_KAPPA1 + 1] = known ? known->kappa2 : 0;
	start.shared[MODEL_KAPPA1 + 2] = known ? known->kappa3 : 0;
	start.shared[MODEL_CENTRE_X] = own->guess.centre[0];
	start.shared[MODEL_CENTRE_Y] = own->guess.centre[1];
	start.shared[MODEL_ASPECT] = own->guess.aspect;
	own->guess_error = camera_guess(&own->problem, &start, own->x);
	if (own->guess_error == -ENOMEM)
		return -ENOMEM;
	if (!own->guess_error)
		err = solve_guessed(own);
	if (!err && finds_lens(own))
		err = choose_radial(own);
	return err;
}
