/* SPDX-License-Identifier: MIT */

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/estimate/linear.h"
#include "bake/calibrate/fisheye/fisheye_parts.h"
#include "hal/optics/vec.h"

#define POINTS_MAX 160 /* of a view: more do not improve a guess */

/* Points of a view with their rays by the trial optics. */
struct start_sight {
	int count;
	double world[POINTS_MAX][3], ray[POINTS_MAX][3];
};

static bool take_view(const struct lens_problem *problem, const struct optics *optics, int view,
		      struct start_sight *sight)
{
	const struct observations *seen = problem->seen;
	const int first = seen->view[view].first, count = seen->view[view].count;
	const int step = (count + POINTS_MAX - 1) / POINTS_MAX;

	sight->count = 0;
	for (int n = 0; n < count; n += step) {
		const struct observation *point = &seen->point[first + n];

		memcpy(sight->world[sight->count], point->world, sizeof(point->world));
		if (!optics_ray(optics, point->px, sight->ray[sight->count]))
			return false;
		sight->count++;
	}
	return true;
}

/* Finds the homography of a board in the camera's axes, ray ~ h (x, y, 1), with x and y relative to
 * their middle in units of their spread. False: its points do not determine it. */
static bool find_plane(const struct start_sight *sight, const double middle[2], double spread,
		       double h[9])
{
	double *a = calloc((size_t)sight->count * 3 * 9 + 81, sizeof(*a));
	const int rows = 3 * sight->count > 9 ? 3 * sight->count : 9;
	double alone;

	if (!a)
		return false;
	for (int n = 0; n < sight->count; n++) {
		const double *ray = sight->ray[n];
		const double at[3] = {(sight->world[n][0] - middle[0]) / spread,
				      (sight->world[n][1] - middle[1]) / spread, 1};
		const double cross[9] = {0,	  -ray[2], ray[1], ray[2], 0,
					 -ray[0], -ray[1], ray[0], 0};

		for (int i = 0; i < 3; i++)
			for (int c = 0; c < 9; c++)
				a[c * rows + 3 * n + i] = cross[3 * i + c / 3] * at[c % 3];
	}
	alone = linear_null(a, rows, 9, h);
	free(a);
	return alone > 1e-7;
}

/* Returns the mean distance of the points from their middle. */
static double measure_plane(const struct start_sight *sight, double middle[2])
{
	double spread = 0;

	middle[0] = middle[1] = 0;
	for (int n = 0; n < sight->count; n++)
		for (int i = 0; i < 2; i++)
			middle[i] += sight->world[n][i] / sight->count;
	for (int n = 0; n < sight->count; n++)
		spread += hypot(sight->world[n][0] - middle[0], sight->world[n][1] - middle[1]) /
			  sight->count;
	return spread;
}

/* Computes rotation and translation from h. */
static bool take_pose(const struct start_sight *sight, const double h[9], const double middle[2],
		      double spread, struct lens_pose *pose)
{
	double x[3], y[3], z[3], ahead = 0, scale;

	for (int i = 0; i < 3; i++) {
		x[i] = h[3 * i] / spread;
		y[i] = h[3 * i + 1] / spread;
	}
	for (int n = 0; n < sight->count; n++)
		for (int i = 0; i < 3; i++)
			ahead += sight->ray[n][i] *
				 (h[3 * i + 2] + x[i] * (sight->world[n][0] - middle[0]) +
				  y[i] * (sight->world[n][1] - middle[1]));
	scale = copysign(1 / sqrt(vec_length(x) * vec_length(y)), ahead);
	if (!isfinite(scale))
		return false;
	for (int i = 0; i < 3; i++) {
		pose->translation[i] = scale * (h[3 * i + 2] - x[i] * middle[0] - y[i] * middle[1]);
		x[i] *= scale;
		y[i] *= scale;
	}
	vec_cross(x, y, z);
	vec_normalize(z);
	vec_normalize(x);
	vec_cross(z, x, y);
	for (int i = 0; i < 3; i++) {
		pose->rotation[3 * i] = x[i];
		pose->rotation[3 * i + 1] = y[i];
		pose->rotation[3 * i + 2] = z[i];
		pose->translation[i] -= z[i] * sight->world[0][2];
	}
	return true;
}

/* Finds the pose of a board, which is flat, at constant Z. Returns the sum of squares left.
 * mirrored: its back is seen. */
static double start_board(struct start_sight *sight, struct lens_pose *pose, bool *mirrored)
{
	double middle[2], h[9], camera[3], squares = 0;
	const double spread = measure_plane(sight, middle);

	if (!(spread > 0) || !find_plane(sight, middle, spread, h) ||
	    !take_pose(sight, h, middle, spread, pose))
		return INFINITY;
	for (int n = 0; n < sight->count; n++) {
		double c[3];

		mat_apply(pose->rotation, sight->world[n], c);
		for (int i = 0; i < 3; i++)
			c[i] += pose->translation[i];
		vec_normalize(c);
		for (int i = 0; i < 3; i++)
			squares += (c[i] - sight->ray[n][i]) * (c[i] - sight->ray[n][i]);
	}
	mat_apply_transposed(pose->rotation, pose->translation, camera);
	*mirrored = -camera[2] < sight->world[0][2];
	return squares;
}

/* Finds the poses for given optics. Returns the mean squared angle left, rad^2; INFINITY: some
 * points have no ray. *mirrored: most boards are seen from behind. */
static double start_poses(const struct lens_problem *problem, struct lens_solution *solution,
			  bool *mirrored)
{
	struct start_sight *sight = malloc(sizeof(*sight));
	double squares = 0;
	int points = 0, wrong = 0;

	for (int p = 0; sight && p < solution->poses; p++) {
		bool back = false;

		if (!take_view(problem, &solution->optics, p, sight)) {
			squares = INFINITY;
			break;
		}
		squares += start_board(sight, &solution->pose[p], &back);
		points += sight->count;
		wrong += back;
	}
	if (!sight)
		squares = INFINITY;
	free(sight);
	*mirrored = 2 * wrong > solution->poses;
	return squares / (points > 0 ? points : 1);
}

/* Computes the middle of the picture, or of the points where its size is not known; returns the
 * largest distance of a point from it. */
static double seen_extent(const struct observations *seen, double squash, double middle[2])
{
	double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, most = 0;

	for (int n = 0; n < seen->count; n++)
		for (int i = 0; i < 2; i++) {
			low[i] = fmin(low[i], seen->point[n].px[i]);
			high[i] = fmax(high[i], seen->point[n].px[i]);
		}
	middle[0] = seen->width ? seen->width / 2.0 : (low[0] + high[0]) / 2;
	middle[1] = seen->height ? seen->height / 2.0 : (low[1] + high[1]) / 2;
	for (int n = 0; n < seen->count; n++)
		most = fmax(most, hypot(seen->point[n].px[0] - middle[0],
					(seen->point[n].px[1] - middle[1]) / squash));
	return most;
}

static int check_start(const struct lens_problem *problem, struct fault *fault)
{
	const struct observations *seen = problem->seen;

	for (int n = 0; n < seen->count; n++) {
		const struct observation *point = &seen->point[n];
		const double *w = point->world;

		if (!isfinite(w[0] + w[1] + w[2] + point->px[0] + point->px[1]))
			return fault_say(fault, -EINVAL,
					 "%s: is not finite, expected finite numbers", point->name);
		if (!(fabs(w[2] - seen->point[seen->view[point->view].first].world[2]) <
		      1e-6 * (1 + hypot(w[0], w[1]))))
			return fault_say(fault, -EINVAL,
					 "%s: expected a flat board, of one Z in each picture",
					 point->name);
	}
	return 0;
}

int lens_start(const struct lens_problem *problem, struct lens_solution *solution, bool *mirrored,
	       struct fault *fault)
{
	static const double squashes[] = {1, 0.5, 2, 0.75, 1.4};
	const enum fisheye_model model = solution->optics.model;
	const struct fisheye_curve curve = {.model = model};
	struct lens_solution trial;
	double best = INFINITY;
	int err;

	*mirrored = false;
	err = check_start(problem, fault);
	if (err)
		return err;
	err = lens_solution_copy(&trial, solution);
	if (err)
		return fault_say(fault, err, "fisheye: out of memory");
	for (unsigned s = 0; s < sizeof(squashes) / sizeof(*squashes); s++)
		for (int deg = 10; deg <= 120; deg += 10) {
			double *number = trial.optics.number, most, squares;
			bool other;

			if (model == FISHEYE_ORTHOGRAPHIC && deg > 90)
				continue;
			memset(number, 0, sizeof(trial.optics.number));
			most = seen_extent(problem->seen, squashes[s], number + OPTICS_CENTRE);
			number[OPTICS_FOCAL] = 1.0001 * most /
					       fisheye_curve_radius(&curve, deg * (M_PI / 180));
			number[OPTICS_FOCAL + 1] = squashes[s] * number[OPTICS_FOCAL];
			squares = start_poses(problem, &trial, &other);
			/* Rays of a longer lens are nearer to each other, and so are the residuals
			 * of a board in any pose; in pixels they are not. */
			squares *= number[OPTICS_FOCAL] * number[OPTICS_FOCAL + 1];
			/* a squash must fit clearly better: it is rare */
			squares *= s ? 1.2 : 1;
			if (!(squares < best))
				continue;
			best = squares;
			*mirrored = other;
			solution->optics = trial.optics;
			memcpy(solution->pose, trial.pose,
			       (size_t)trial.poses * sizeof(*trial.pose));
		}
	lens_solution_free(&trial);
	if (!(best < INFINITY))
		return fault_say(fault, -ERANGE, "no lens fits the points at all");
	return 0;
}
