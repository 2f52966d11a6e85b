/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/camera/camera_problem.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/estimate/order.h"
#include "bake/calibrate/estimate/rotation.h"
#include "hal/optics/vec.h"

#define GUESS_POINTS 200 /* number of points that suffices to judge a guess */
#define SAMPLES                                                                                    \
	50 /* random samples of a robust guess: of 30 % outliers one is free of them with 98 % */
#define SAMPLE_POINTS 7 /* points of a view in a sample */
/* Fewest points of all views for an unknown lens, and of a view for its pose. */
#define FEWEST_POINTS 5
#define FEWEST_OF_VIEW 4

enum { COARSE = 15, FINE = 6 }; /* focal lengths tried */

struct guesser {
	const struct camera_problem *problem;
	const struct camera_start *start;
	int *chosen;	   /* [count]: indices of points, view after view */
	int *chosen_first; /* [views + 1] */
	/* These are of the chosen points; places are in units of their views' sizes. */
	double (*place)[3], (*sensor)[2],
		(*seen)[2];   /* sensor: without distortion; seen: in focal lengths */
	double *error;	      /* [count] */
	double *best, *trial; /* [unknowns] */
};

static void guesser_free(struct guesser *g)
{
	free(g->chosen);
	free(g->chosen_first);
	free(g->place);
	free(g->sensor);
	free(g->seen);
	free(g->error);
	free(g->best);
	free(g->trial);
}

static int guesser_create(struct guesser *g, const struct camera_problem *problem,
			  const struct camera_start *start)
{
	const size_t n = (size_t)problem->count, views = (size_t)problem->views;

	*g = (struct guesser){.problem = problem, .start = start};
	g->chosen = calloc(n, sizeof(*g->chosen));
	g->chosen_first = calloc(views + 1, sizeof(*g->chosen_first));
	g->place = calloc(n, sizeof(*g->place));
	g->sensor = calloc(n, sizeof(*g->sensor));
	g->seen = calloc(n, sizeof(*g->seen));
	g->error = calloc(n, sizeof(*g->error));
	g->best = calloc((size_t)problem_unknowns(problem), sizeof(*g->best));
	g->trial = calloc((size_t)problem_unknowns(problem), sizeof(*g->trial));
	if (g->chosen && g->chosen_first && g->place && g->sensor && g->seen && g->error &&
	    g->best && g->trial)
		return 0;
	guesser_free(g);
	return -ENOMEM;
}

/* ---- one guess ---- */

/* Sum of the squared distances on the sensor from where a pose shows the chosen points; infinite
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

	for (int c = 0; c < g->chosen_first[g->problem->views]; c++)
		for (int k = 0; k < 2; k++)
			g->seen[c][k] = g->sensor[c][k] / focal;
	for (int v = 0; v < g->problem->views && isfinite(squares); v++) {
		const int first = g->chosen_first[v], count = g->chosen_first[v + 1] - first;
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

/* Computes a guess from the chosen points, by the kappas of the start. Returns 0; -ERANGE: the
 * points do not determine one. */
static int guess_from_chosen(struct guesser *g, double *x)
{
	const struct camera_start *start = g->start;
	const struct camera_problem *problem = g->problem;
	const size_t bytes = (size_t)problem_unknowns(problem) * sizeof(*x);
	/* f as shares of the points' reach: from wide angles to what is nearly orthographic */
	static const double of_reach[COARSE] = {0.5, 0.7, 1,  1.4, 2,  2.8, 4,	 5.6,
						8,   11,  16, 32,  64, 200, 1000};
	double best = INFINITY, middle = 0;

	if (!start->known && g->chosen_first[problem->views] < FEWEST_POINTS)
		return -ERANGE;
	for (int c = 0; c < g->chosen_first[problem->views]; c++) {
		const int i = g->chosen[c];

		for (int k = 0; k < 3; k++)
			g->place[c][k] =
				problem->place[i][k] /
				problem->shape[problem->point[i].view - problem->first_view].size;
		if (!model_straighten(&problem->model, start->shared, problem->point[i].px,
				      g->sensor[c]))
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

/* Chooses all points of each view. */
static void choose_every(struct guesser *g)
{
	const struct camera_problem *problem = g->problem;
	int count = 0;

	for (int v = 0; v < problem->views; v++) {
		g->chosen_first[v] = count;
		for (int i = problem->first[v]; i < problem->first[v + 1]; i++)
			if (!problem->unused || !problem->unused[i])
				g->chosen[count++] = i;
	}
	g->chosen_first[problem->views] = count;
}

/* splitmix64: the same samples every time. */
static unsigned long long next_random(unsigned long long *state)
{
	unsigned long long z = *state += 0x9e3779b97f4a7c15;

	z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
	z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
	return z ^ (z >> 31);
}

/* Chooses SAMPLE_POINTS random points of each view. */
static void choose_some(struct guesser *g, unsigned long long *random)
{
	int count = 0;

	choose_every(g);
	for (int v = 0; v < g->problem->views; v++) {
		const int first = g->chosen_first[v], all = g->chosen_first[v + 1] - first;
		const int take = all < SAMPLE_POINTS ? all : SAMPLE_POINTS;

		for (int k = 0; k < take; k++) {
			const int other =
				k + (int)(next_random(random) % (unsigned long long)(all - k));
			const int swap = g->chosen[first + k];

			g->chosen[first + k] = g->chosen[first + other];
			g->chosen[first + other] = swap;
		}
		g->chosen_first[v] = count;
		memmove(g->chosen + count, g->chosen + first, (size_t)take * sizeof(*g->chosen));
		count += take;
	}
	g->chosen_first[g->problem->views] = count;
}

/* Returns the median distance between seen and projected points, over at most some hundred points;
 * points without an image count as infinite. */
static double median_error(struct guesser *g, const double *x)
{
	const struct camera_problem *problem = g->problem;
	const int stride = 1 + problem->count / GUESS_POINTS;
	struct model_view turned;
	int count = 0, view = -1;

	for (int i = 0; i < problem->count; i += stride) {
		const struct observation *point = &problem->point[i];
		double px[2];

		if (problem->unused && problem->unused[i])
			continue;
		if (point->view != view) {
			view = point->view;
			model_turn(&turned, x + model_of_view(view - problem->first_view));
		}
		g->error[count++] = model_see(&problem->model, x, &turned, problem->place[i], px,
					      NULL)
					    ? hypot(px[0] - point->px[0], px[1] - point->px[1])
					    : INFINITY;
	}
	qsort(g->error, (size_t)count, sizeof(*g->error), order_doubles);
	return count ? g->error[count / 2] : INFINITY;
}

/* Improves on a guess from all points, of which err tells whether there is one, by random samples:
 * the least median error counts. */
static int try_samples(struct guesser *g, int err, double *x)
{
	unsigned long long random = 1;
	double best = err ? INFINITY : median_error(g, x);

	for (int k = 0; k < SAMPLES; k++) {
		double median;

		choose_some(g, &random);
		if (guess_from_chosen(g, g->best))
			continue;
		median = median_error(g, g->best);
		if (median < best) {
			best = median;
			err = 0;
			memcpy(x, g->best, (size_t)problem_unknowns(g->problem) * sizeof(*x));
		}
	}
	return err;
}

int camera_guess(const struct camera_problem *problem, const struct camera_start *start, double *x)
{
	struct guesser g;
	int err = guesser_create(&g, problem, start);

	if (err)
		return err;
	choose_every(&g);
	err = guess_from_chosen(&g, x);
	if (start->robust)
		err = try_samples(&g, err, x);
	guesser_free(&g);
	return err;
}
