/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/camera/camera_problem.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/estimate/rotation.h"
#include "hal/optics/vec.h"

/* Fewest points of all views for an unknown lens, and of a view for its pose. */
#define FEWEST_POINTS 5
#define FEWEST_OF_VIEW 4

enum { COARSE = 15, FINE = 6 }; /* focal lengths tried */

struct guesser {
	const struct camera_problem *problem;
	const struct camera_start *start;
	/* [count]; places are in units of their views' sizes. */
	double (*place)[3], (*sensor)[2],
		(*seen)[2]; /* sensor: without distortion; seen: in focal lengths */
	double *trial;	    /* [unknowns] */
};

static void guesser_free(struct guesser *g)
{
	free(g->place);
	free(g->sensor);
	free(g->seen);
	free(g->trial);
}

static int guesser_create(struct guesser *g, const struct camera_problem *problem,
			  const struct camera_start *start)
{
	const size_t n = (size_t)problem->count;

	*g = (struct guesser){.problem = problem, .start = start};
	g->place = calloc(n, sizeof(*g->place));
	g->sensor = calloc(n, sizeof(*g->sensor));
	g->seen = calloc(n, sizeof(*g->seen));
	g->trial = calloc((size_t)problem_unknowns(problem), sizeof(*g->trial));
	if (g->place && g->sensor && g->seen && g->trial)
		return 0;
	guesser_free(g);
	return -ENOMEM;
}

/* ---- one guess ---- */

/* Sum of the squared distances on the sensor from where a pose shows points; infinite
 * where one is behind the camera. */
static double pose_squares(const struct guesser *g, int first, int end, double focal,
			   const double *pose)
{
	struct model_view view;
	double squares = 0;

	model_turn(&view, pose);
	for (int c = first; c < end; c++) {
		double at[3];

		mat_apply(view.rotation, g->place[c], at);
		if (!(at[2] + view.translation[2] > 0))
			return INFINITY;
		for (int k = 0; k < 2; k++)
			squares += pow(focal * (at[k] + view.translation[k]) /
						       (at[2] + view.translation[2]) -
					       g->sensor[c][k],
				       2);
	}
	return squares;
}

/* Finds the poses of all views for one f. Returns the sum of squares; infinite: there are none.
 * A view without points gets an arbitrary one. */
static double find_poses(struct guesser *g, double focal, double *x)
{
	static const double nothing[MODEL_OF_VIEW] = {[MODEL_TRANSLATION + 2] = 1};
	double squares = 0;

	for (int c = 0; c < g->problem->count; c++)
		for (int k = 0; k < 2; k++)
			g->seen[c][k] = g->sensor[c][k] / focal;
	for (int v = 0; v < g->problem->views && isfinite(squares); v++) {
		const int first = g->problem->first[v], count = g->problem->first[v + 1] - first;
		double *pose = x + model_of_view(v);

		memcpy(pose, nothing, sizeof(nothing));
		if (!count)
			continue;
		if (count < FEWEST_OF_VIEW ||
		    !camera_pose(count, g->place + first, g->seen + first, pose))
			return INFINITY;
		squares += pose_squares(g, first, first + count, focal, pose);
		for (int k = 0; k < 3; k++)
			pose[MODEL_TRANSLATION + k] *= g->problem->shape[v].size;
	}
	x[MODEL_FOCAL] = focal;
	return squares;
}

/* Computes a guess by the kappas of the start. Returns 0; -ERANGE: the points do not determine
 * one. */
static int guess_from_points(struct guesser *g, double *x)
{
	const struct camera_start *start = g->start;
	const struct camera_problem *problem = g->problem;
	const size_t bytes = (size_t)problem_unknowns(problem) * sizeof(*x);
	/* f as shares of the points' reach: from wide angles to what is nearly orthographic */
	static const double of_reach[COARSE] = {0.5, 0.7, 1,  1.4, 2,  2.8, 4,	 5.6,
						8,   11,  16, 32,  64, 200, 1000};
	double best = INFINITY, middle = 0;

	if (!start->known && problem->count < FEWEST_POINTS)
		return -ERANGE;
	for (int i = 0; i < problem->count; i++) {
		const struct observation *point = &problem->point[i];

		for (int k = 0; k < 3; k++)
			g->place[i][k] = problem->place[i][k] /
					 problem->shape[point->view - problem->first_view].size;
		if (!model_straighten(&problem->model, start->shared, point->px, g->sensor[i]))
			return -ERANGE;
	}
	memcpy(g->trial, start->shared, sizeof(start->shared));
	/* then between the best one and its neighbours, as an f that is far off may choose a
	 * wrong tilt */
	for (int k = 0; k < (start->known ? 1 : COARSE + FINE); k++) {
		double focal = start->known ? start->shared[MODEL_FOCAL]
					    : of_reach[k % COARSE] * problem->reach;
		double squares;

		if (k == COARSE)
			middle = x[MODEL_FOCAL];
		if (k >= COARSE)
			focal = middle * exp2((k - COARSE - (FINE - 1) / 2.0) / (FINE - 1));
		squares = find_poses(g, focal, g->trial);
		if (squares < best) {
			best = squares;
			memcpy(x, g->trial, bytes);
		}
	}
	return isfinite(best) ? 0 : -ERANGE;
}

/* ---- tilts ---- */

void camera_tilt(const struct camera_problem *problem, int view, const double *x, double *tilted)
{
	const double *pose = x + model_of_view(view);
	double rotation[9], slope[3][9], back[9], normal[3], axis[3], sight[3], turned[9];
	double angle;

	rotation_from_vector(pose + MODEL_ROTATION, rotation, slope);
	memcpy(sight, pose + MODEL_TRANSLATION, sizeof(sight));
	vec_normalize(sight);
	mat_apply(rotation, problem->shape[view].axes + 6, normal);
	vec_cross(normal, sight, axis);
	angle = 2 * atan2(vec_normalize(axis), fabs(vec_dot(normal, sight)));
	if (vec_dot(normal, sight) < 0)
		angle = -angle;
	for (int k = 0; k < 3; k++)
		axis[k] *= angle;
	rotation_from_vector(axis, back, slope);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			turned[3 * i + j] = back[3 * i] * rotation[j] +
					    back[3 * i + 1] * rotation[3 + j] +
					    back[3 * i + 2] * rotation[6 + j];
	rotation_to_vector(turned, tilted);
	memcpy(tilted + MODEL_TRANSLATION, pose + MODEL_TRANSLATION, 3 * sizeof(*tilted));
}

int camera_guess(const struct camera_problem *problem, const struct camera_start *start, double *x)
{
	struct guesser g;
	int err = guesser_create(&g, problem, start);

	if (err)
		return err;
	err = guess_from_points(&g, x);
	guesser_free(&g);
	return err;
}
