/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/camera/camera_guess_closed.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "bake/calibrate/camera/camera_tsai.h"
#include "bake/calibrate/estimate/rotation.h"
#include "hal/optics/vec.h"

static int gather_view_points(struct guesser *g, int view)
{
	const struct camera_problem *problem = g->problem;
	const double *axes = problem->shape[view].axes;

	g->points.count = 0;
	for (int c = g->chosen_first[view]; c < g->chosen_first[view + 1]; c++) {
		const int i = g->chosen[c], at = g->points.count++;

		memcpy(g->points.place[at], problem->place[i], sizeof(problem->place[i]));
		for (int k = 0; k < 2; k++)
			g->points.plane[at][k] = vec_dot(axes + 3 * k, problem->place[i]);
		if (!model_straighten(&problem->model, g->shared, problem->point[i].px,
				      g->points.sensor[at]))
			return -ERANGE;
	}
	return 0;
}

static void put_pose(double *x, int view, const double rotation[9], const double translation[3])
{
	rotation_to_vector(rotation, x + model_of_view(view) + MODEL_ROTATION);
	memcpy(x + model_of_view(view) + MODEL_TRANSLATION, translation, 3 * sizeof(*x));
}

/* Turns a pose of the view's own axes into one of the world's: R axes. */
static void put_plane_pose(struct guesser *g, double *x, int view, const struct first_guess *guess)
{
	const double *axes = g->problem->shape[view].axes, *r = guess->rotation;
	double rotation[9];

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			rotation[3 * i + j] = r[3 * i] * axes[j] + r[3 * i + 1] * axes[3 + j] +
					      r[3 * i + 2] * axes[6 + j];
	put_pose(x, view, rotation, guess->translation);
}

/* Returns the RMS distance in one view, over at most some hundred points; infinite where one has no
 * image. */
static double trial_rms(const struct guesser *g, int view, const double *x)
{
	const struct camera_problem *problem = g->problem;
	const int first = problem->first[view], end = problem->first[view + 1];
	const int stride = 1 + (end - first) / GUESS_POINTS;
	struct model_view turned;
	double squares = 0;
	int count = 0;

	model_turn(&turned, x + model_of_view(view));
	for (int i = first; i < end; i += stride) {
		double px[2];

		if (problem->unused && problem->unused[i])
			continue;
		if (!model_see(&problem->model, x, &turned, problem->place[i], px, NULL))
			return INFINITY;
		squares += pow(px[0] - problem->point[i].px[0], 2) +
			   pow(px[1] - problem->point[i].px[1], 2);
		count++;
	}
	return count ? sqrt(squares / count) : INFINITY;
}

static int pose_of_view(struct guesser *g, int view, double *x)
{
	struct first_guess guess;
	int err;

	if (g->has_h[view]) {
		homography_pose(g->h[view], x[MODEL_FOCAL], &guess);
		put_plane_pose(g, x, view, &guess);
		return 0;
	}
	err = gather_view_points(g, view);
	if (!err)
		err = tsai_spatial(g->points.count, g->points.place, g->points.sensor,
				   x[MODEL_FOCAL], &guess);
	if (!err)
		put_pose(x, view, guess.rotation, guess.translation);
	return err;
}

/* The same by Tsai's stage with f given. A plane seen from afar needs it: its homography does not
 * determine its tilt. */
static int tsai_pose_of_plane(struct guesser *g, int view, double *x)
{
	struct first_guess guess;
	int err = gather_view_points(g, view);

	if (!err)
		err = tsai_coplanar(g->points.count, g->points.plane, g->points.sensor,
				    x[MODEL_FOCAL], &guess);
	if (!err)
		put_plane_pose(g, x, view, &guess);
	return err;
}

/* Where Tsai's stage yields no f: takes one of some usual focal lengths, with the pose that fits
 * best. */
static int usual_focal(struct guesser *g, int view, double *x)
{
	static const double of_reach[] = {1, 1.5, 2.5, 4, 8, 16, 40, 200, 1000};
	double best = INFINITY, focal = 0, pose[MODEL_OF_VIEW];

	for (unsigned k = 0; k < 2 * sizeof(of_reach) / sizeof(*of_reach); k++) {
		double rms;
		int err;

		if (k % 2 && !g->has_h[view])
			continue;
		x[MODEL_FOCAL] = of_reach[k / 2] * g->problem->reach;
		err = (k % 2 ? tsai_pose_of_plane : pose_of_view)(g, view, x);
		if (err == -ENOMEM)
			return err;
		rms = err ? INFINITY : trial_rms(g, view, x);
		if (rms < best) {
			best = rms;
			focal = x[MODEL_FOCAL];
			memcpy(pose, x + model_of_view(view), sizeof(pose));
		}
	}
	if (!(focal > 0))
		return -ERANGE;
	x[MODEL_FOCAL] = focal;
	memcpy(x + model_of_view(view), pose, sizeof(pose));
	return 0;
}

double guess_good_enough(const struct guesser *g)
{
	return 0.01 * g->problem->reach / g->problem->model.pixel[0];
}

/* Takes f from Tsai's stage, or a usual f where that fits better: for a plane seen from afar, or
 * parallel to the picture, the f of Tsai's stage is mere noise. */
static int focal_of_plane(struct guesser *g, int view, double *x)
{
	double own[MODEL_GRADIENT], *pose = x + model_of_view(view);
	struct first_guess guess;
	double rms;
	int err = gather_view_points(g, view);

	if (!err)
		err = tsai_coplanar(g->points.count, g->points.plane, g->points.sensor, 0, &guess);
	if (err)
		return err == -ENOMEM ? err : usual_focal(g, view, x);
	x[MODEL_FOCAL] = guess.focal;
	put_plane_pose(g, x, view, &guess);
	rms = trial_rms(g, view, x);
	if (rms < guess_good_enough(g))
		return 0;
	memcpy(own, x, MODEL_SHARED * sizeof(*own));
	memcpy(own + MODEL_SHARED, pose, MODEL_OF_VIEW * sizeof(*own));
	err = usual_focal(g, view, x);
	if (!err && trial_rms(g, view, x) < rms)
		return 0;
	memcpy(x, own, MODEL_SHARED * sizeof(*own));
	memcpy(pose, own + MODEL_SHARED, MODEL_OF_VIEW * sizeof(*own));
	return err == -ENOMEM ? err : 0;
}

static int find_homographies(struct guesser *g)
{
	for (int v = 0; v < g->problem->views; v++) {
		int err = 0;

		g->has_h[v] = problem_flat(g->problem, v) &&
			      g->chosen_first[v + 1] - g->chosen_first[v] >= 4;
		if (g->has_h[v])
			err = gather_view_points(g, v);
		if (!err && g->has_h[v])
			err = homography_find(g->points.count, g->points.plane, g->points.sensor,
					      g->h[v]);
		if (err == -ENOMEM)
			return err;
		g->has_h[v] &= !err;
	}
	return 0;
}

/* Finds f from the view with most points in space, else from all planes, else from the only one. */
static int find_focal(struct guesser *g, double *x)
{
	const struct camera_problem *problem = g->problem;
	double(*kept)[9] = g->h;
	int spatial = -1, most = 0, planes = 0, any = -1;
	struct first_guess guess;

	for (int v = 0; v < problem->views; v++) {
		const int count = g->chosen_first[v + 1] - g->chosen_first[v];

		if (!problem_flat(problem, v) && count > most) {
			spatial = v;
			most = count;
		}
		planes += g->has_h[v];
		any = g->has_h[v] ? v : any;
	}
	if (spatial >= 0 && most >= 7) {
		int err = gather_view_points(g, spatial);

		if (!err)
			err = tsai_spatial(g->points.count, g->points.place, g->points.sensor, 0,
					   &guess);
		if (err == -EDOM)
			return usual_focal(g, spatial, x);
		x[MODEL_FOCAL] = guess.focal;
		if (!err)
			x[MODEL_ASPECT] *= guess.aspect;
		return err;
	}
	if (planes > 1 && planes == problem->views &&
	    !homography_focal(planes, kept, &x[MODEL_FOCAL]))
		return 0;
	if (any < 0)
		return -ERANGE;
	return planes == 1 ? focal_of_plane(g, any, x) : usual_focal(g, any, x);
}

/* Finds the pose of one view for known f; a view without points gets an arbitrary one. */
static int find_pose(struct guesser *g, int view, double *x)
{
	const double nothing[3] = {0, 0, 1}, straight[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

	if (g->chosen_first[view + 1] > g->chosen_first[view])
		return pose_of_view(g, view, x);
	put_pose(x, view, straight, nothing);
	return 0;
}

int guess_from_chosen(struct guesser *g, double kappa, double *x)
{
	const struct camera_start *start = g->start;
	const bool lone = g->problem->views == 1 && !start->known;
	int err;

	memcpy(g->shared, start->shared, sizeof(g->shared));
	g->shared[MODEL_KAPPA1] = kappa;
	memcpy(x, g->shared, sizeof(g->shared));
	err = find_homographies(g);
	if (!err && !start->known)
		err = find_focal(g, x);
	/* Tsai's stage has found the pose of a lone plane already. */
	for (int v = 0; v < g->problem->views && !err && !(lone && g->has_h[v]); v++)
		err = find_pose(g, v, x);
	return err;
}
