/* SPDX-License-Identifier: MIT */
/*
 * Reasons to doubt a camera, in order of gravity, each with its remedy. Most follow Willson's and
 * Tsai's notes on where the method fails.
 */
#include <errno.h>
#include <math.h>
#include <stdio.h>

#include "bake/calibrate/camera/camera_parts.h"
#include "hal/optics/vec.h"

#define OUTLIER_SIGMAS 7.0 /* limit of an outlier in a plain fit: chance exceeds it once in 1e10 */
#define OUTLIERS_MOST 0.25 /* largest share of outliers */
#define OUTLIERS_PULL 0.3  /* largest share of outliers in the sum of squares */
#define FOCAL_LOST 0.15	   /* relative deviation beyond which first order says nothing */
#define PARALLEL_DEGREES 10
/* largest distance of the object from the points' middle, in units of their extent */
#define BEYOND_MOST 1.25
/* A mean residual of a part of the picture is doubted beyond so many of its deviations (of 38 means
 * chance exceeds that once in 40,000 runs) and this share of the tolerance. */
#define STRUCTURE_SIGMAS 5.0
#define STRUCTURE_LEAST 0.1
#define MISFIT 0.02 /* largest rms, as a share of the points' extent */

/* ---- what came out ---- */

static void judge_guess(struct camera_solution *solution)
{
	const struct camera_private *own = solution->own;

	if (own->guess_error == -EDOM)
		verdict_doubt(&solution->finding.verdict, "check which point is which",
			      "no camera sees the points in this order");
	if (own->guess_error)
		verdict_doubt(&solution->finding.verdict,
			      "check which point is which, and spread the points",
			      "the points leave open where the camera is");
}

/* Angle between the view's plane and the picture, degrees. */
static double tilt_of(const struct camera_private *own, int view)
{
	const double *normal = own->problem.shape[view].axes + 6;
	struct model_view turned;

	model_turn(&turned, own->x + model_of_view(view));
	return acos(fmin(1, fabs(vec_dot(turned.rotation + 6, normal)))) * 180 / M_PI;
}

/* Whether all views are planes parallel to the picture. */
static bool all_parallel(const struct camera_private *own)
{
	for (int v = 0; v < own->problem.views; v++)
		if (own->problem.first[v + 1] > own->problem.first[v] &&
		    (!problem_flat(&own->problem, v) || tilt_of(own, v) > PARALLEL_DEGREES))
			return false;
	return true;
}

static void doubt_focal(struct camera_solution *solution)
{
	if (all_parallel(solution->own))
		verdict_doubt(
			&solution->finding.verdict, "tilt it by 30 degrees or more",
			"the board is parallel to the image plane: f and distance cannot be told apart");
	else
		verdict_doubt(
			&solution->finding.verdict,
			"come closer, use a larger or more tilted board, give --intrinsics, or check whether y counts upwards (--y-up)",
			"the points are so far away for their extent that the picture is nearly orthographic: f and distance cannot be told apart");
}

static bool focal_lost(const struct camera_private *own, double variance)
{
	return !own->task.intrinsics && !(sqrt(variance) < FOCAL_LOST * own->x[MODEL_FOCAL]);
}

/* Judges the descent. One that did not converge may have been on its way to an infinite f. */
static void judge_fit(struct camera_solution *solution)
{
	const struct camera_private *own = solution->own;
	const double *variance = own->fit.covariance;

	if (own->guess_error)
		return;
	if (own->fit_error == -EDOM)
		verdict_doubt(&solution->finding.verdict, "check which point is which",
			      "no camera was found that sees every point");
	else if ((own->fit_error && isinf(variance[MODEL_FOCAL])) ||
		 (own->fit_error == -ETIMEDOUT && focal_lost(own, variance[MODEL_FOCAL])))
		doubt_focal(solution);
	else if (own->fit_error == -ERANGE)
		verdict_doubt(&solution->finding.verdict,
			      "spread the points over the picture and in depth", "%s",
			      own->why.text);
	else if (own->fit_error)
		verdict_doubt(&solution->finding.verdict,
			      "check which point is which, or use --robust", "%s", own->why.text);
}

static double extent_px(const struct camera_problem *problem)
{
	double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};

	for (int i = 0; i < problem->count; i++)
		for (int k = 0; k < 2; k++) {
			low[k] = fmin(low[k], problem->point[i].px[k]);
			high[k] = fmax(high[k], problem->point[i].px[k]);
		}
	return hypot(high[0] - low[0], high[1] - low[1]);
}

static double distance_px(const struct camera_solution *solution, int i)
{
	const struct finding *finding = &solution->finding;

	return hypot(finding->expected[i][0] - solution->own->problem.point[i].px[0],
		     finding->expected[i][1] - solution->own->problem.point[i].px[1]);
}

/* Median distance by bisection, which needs no memory for sorting. */
static double typical_distance(const struct camera_solution *solution)
{
	const int count = solution->own->problem.count;
	double low = 0, high = 0;

	for (int i = 0; i < count; i++)
		high = fmax(high, distance_px(solution, i));
	for (int step = 0; step < 50; step++) {
		const double middle = (low + high) / 2;
		int within = 0;

		for (int i = 0; i < count; i++)
			within += distance_px(solution, i) <= middle;
		if (2 * within >= count)
			high = middle;
		else
			low = middle;
	}
	return high;
}

/* Doubts views most of whose points do not fit: they have no pose, however well the others fit. */
static void judge_views(struct camera_solution *solution)
{
	const struct camera_private *own = solution->own;

	for (int v = 0; v < own->problem.views; v++) {
		const int first = own->problem.first[v], end = own->problem.first[v + 1];
		int outliers = 0;

		for (int i = first; i < end; i++)
			outliers += solution->finding.weight[i] < 0.1;
		if (end > first && 2 * outliers >= end - first)
			verdict_doubt(&solution->finding.verdict,
				      "measure them again, or leave this view out",
				      "%d of %d points of %s do not fit the other views", outliers,
				      end - first,
				      own->seen->view[v + own->problem.first_view].name);
	}
}

static void judge_outliers(struct camera_solution *solution)
{
	const struct camera_private *own = solution->own;
	const struct finding *finding = &solution->finding;
	/* the median of a Rayleigh distribution is 1.18 sigma */
	const double sigma = fmax(typical_distance(solution) / 1.18, CAMERA_NOISE_LEAST);
	double squares = 0, pull = 0;
	int worst = 0, outliers = 0;

	for (int i = 0; i < own->problem.count; i++) {
		const double off = distance_px(solution, i);
		const bool out = own->task.robust ? finding->weight[i] < 0.1
						  : off > OUTLIER_SIGMAS * sigma;

		outliers += out;
		squares += off * off;
		pull += out ? off * off : 0;
		if (off > distance_px(solution, worst))
			worst = i;
	}
	if (outliers > OUTLIERS_MOST * own->problem.count)
		verdict_doubt(&solution->finding.verdict,
			      "measure them again, and check that the board is the one named",
			      "%d of %d points do not fit the others, %s the worst", outliers,
			      own->problem.count, own->problem.point[worst].name);
	else if (!own->task.robust && pull > OUTLIERS_PULL * squares)
		verdict_doubt(
			&solution->finding.verdict, "measure it again, or use --robust",
			"%s is %.3g px from where the others say it should be, which are off by %.2g px",
			own->problem.point[worst].name, distance_px(solution, worst), sigma);
	if (finding->rms_px > MISFIT * extent_px(&own->problem))
		verdict_doubt(
			&solution->finding.verdict,
			"check which point is which, whether y counts upwards (--y-up), that the world's axes are right-handed, the board's numbers, and --distortion",
			"the points are %.3g px off on average: they are no picture of such a board by such a lens",
			finding->rms_px);
}

/* A plane seen from behind looks like one whose points are mirrored; only the side tells, because
 * the world's Z is up. */
static void judge_side(struct camera_solution *solution)
{
	const struct camera_private *own = solution->own;
	const struct view_shape *shape = &own->problem.shape[own->task.reference];
	const struct tsai_camera *camera = &solution->camera;
	double eye[3];

	mat_apply_transposed(camera->rotation, camera->translation, eye);
	if (!problem_flat(&own->problem, own->task.reference) || fabs(shape->axes[8]) < 0.5 ||
	    (-eye[2] < shape->middle[2]) == own->task.z_down)
		return;
	verdict_doubt(
		&solution->finding.verdict,
		own->task.z_down
			? "check the order of the points and --y-up, or leave --z-down away"
			: "check the order of the points and --y-up, or say --z-down if Z points into the board",
		"the board is seen from behind, the camera at Z = %.4g: the points are mirrored, or Z is not up",
		-eye[2]);
}

static void judge_fold(struct camera_solution *solution)
{
	const struct camera_private *own = solution->own;
	const double *x = own->x;
	double farthest = 0, seen[2], reach;
	const double most = camera_grows_to(own, &reach);

	for (int i = 0; i < own->problem.count; i++) {
		const double *px = own->problem.point[i].px;
		const double dx = (px[0] - x[MODEL_CENTRE_X]) * own->problem.model.pixel[0];
		const double dy = (px[1] - x[MODEL_CENTRE_Y]) * own->problem.model.pixel[1];

		if (solution->finding.weight[i] < 0.1)
			continue;
		farthest = fmax(farthest, hypot(dx / x[MODEL_ASPECT], dy));
	}
	if (farthest > 0.995 * most)
		verdict_doubt(
			&solution->finding.verdict,
			"leave out the outermost points, or try the other --distortion",
			"the distortion folds over at the outermost points: the lens bends more than %d radial term%s can say",
			own->radial, own->radial > 1 ? "s" : "");
	if (!camera_sees(own, own->object, seen))
		verdict_doubt(&solution->finding.verdict,
			      "say where the object stands with --object, or cover its place",
			      "the camera has no image of the object's place (%.4g %.4g %.4g)",
			      own->object[0], own->object[1], own->object[2]);
}

/* Doubts a distortion of more terms that folds over inside of the picture, and one of too few
 * terms. */
static void judge_radial(struct camera_solution *solution)
{
	const struct camera_private *own = solution->own;
	const double *left_out = own->left_out;
	const int now = own->radial, wanted = own->radial_wanted;
	double reach, grows = camera_grows_to(own, &reach);

	if (own->radial > 1 && !(grows > reach))
		verdict_doubt(
			&solution->finding.verdict,
			"put points near the corners, or give a smaller --radial",
			"the distortion folds over inside of the picture, at %.3g of the way from the axis to the farthest corner",
			grows / reach);
	if (wanted > now && left_out[now] * left_out[now] - left_out[wanted] * left_out[wanted] >
				    CAMERA_NOISE_LEAST * CAMERA_NOISE_LEAST) {
		char remedy[64];

		snprintf(remedy, sizeof(remedy), "give --radial %d, or leave --radial out", wanted);
		verdict_doubt(
			&solution->finding.verdict, remedy,
			"the lens bends in another way than %d radial term%s can say: %d predict points that were left out to %.3g px, %d to %.3g px",
			now, now > 1 ? "s" : "", wanted, left_out[wanted], now, left_out[now]);
	}
}

/* Doubts a lens whose residuals have a pattern: its deviations assume noise. */
static void judge_structure(struct camera_solution *solution)
{
	const struct camera_private *own = solution->own;
	const double least = fmax(STRUCTURE_LEAST * own->task.tolerance_px, CAMERA_NOISE_LEAST);
	struct camera_structure found;
	char place[96];

	camera_find_structure(own, &found);
	if (!(found.sigmas > STRUCTURE_SIGMAS) || !(fabs(found.mean_px) > least))
		return;
	if (found.ring)
		snprintf(place, sizeof(place), "between %.0f and %.0f px from the axis",
			 found.from_px, found.to_px);
	else
		snprintf(place, sizeof(place), "around %.0f, %.0f px", found.at_px[0],
			 found.at_px[1]);
	verdict_doubt(
		&solution->finding.verdict,
		own->task.intrinsics
			? "check that the lens is the one of --intrinsics, at the same focus and zoom, and that the board is flat"
			: "check that the board is flat, and that all pictures are of one camera at one focus and zoom",
		"the points do not lie where such a lens shows them: %s they are %.3g px off on average, where noise explains %.2g px",
		place, fabs(found.mean_px), found.deviation_px);
}

static void judge_focal(struct camera_solution *solution)
{
	const struct camera_private *own = solution->own;
	const double rms = solution->finding.rms_px;

	/* the effect of a wrong s on f does not depend on the distance */
	if (focal_lost(own, own->uncertainty.cautious[MODEL_FOCAL] -
				    own->uncertainty.held_aspect[MODEL_FOCAL]))
		doubt_focal(solution);
	if (own->other_tilt * own->other_tilt - rms * rms >=
	    9 * fmax(rms * rms, CAMERA_NOISE_LEAST * CAMERA_NOISE_LEAST) / own->problem.count)
		return;
	verdict_doubt(
		&solution->finding.verdict,
		"come closer, tilt the board by 30 degrees or more, or use points in space",
		"the board looks the same tilted the other way: the picture is nearly orthographic");
}

/* Doubts the held axis or s, whichever is worse, if it leaves the object more uncertain than noise
 * does. */
static void judge_held(struct camera_solution *solution)
{
	const struct camera_private *own = solution->own;
	const double axis = camera_object_error(own, own->uncertainty.held);
	const double aspect = camera_object_error(own, own->uncertainty.held_aspect);

	if (own->uncertainty.noise_error > own->task.tolerance_px &&
	    !(fmax(axis, aspect) > own->uncertainty.noise_error))
		return;
	if (aspect > axis)
		verdict_doubt(
			&solution->finding.verdict,
			"give --aspect 1 if they are, or add points in depth or views of the board, tilted otherwise, or give --intrinsics",
			"the points do not tell whether the pixels are square: were s %.3g from the %g where it is held, the object's picture would be off by %.3g px",
			own->guess.aspect_deviation, own->guess.aspect,
			own->uncertainty.object_error);
	verdict_doubt(
		&solution->finding.verdict,
		"add points in depth or views of the board, tilted otherwise, or give --intrinsics, or --centre and --centre-deviation",
		"the points do not tell where the lens's axis is: were it %.3g px from where it is held, the object's picture would be off by %.3g px",
		own->guess.centre_deviation[0], own->uncertainty.object_error);
}

static void judge_object(struct camera_solution *solution)
{
	const struct camera_private *own = solution->own;

	if (own->fit.freedom <= 0)
		verdict_doubt(
			&solution->finding.verdict, "add points",
			"there are as many unknowns as measurements: nothing says how well they fit");
	if (own->uncertainty.object_error <= own->task.tolerance_px)
		return;
	if (!own->task.intrinsics && all_parallel(own))
		doubt_focal(solution);
	judge_held(solution);
	verdict_doubt(&solution->finding.verdict,
		      "add points around that place, in depth too, or more views of the board",
		      "the " CAMERA_OBJECT_ERROR " is %.6g px, more than the %g px of --tolerance",
		      own->uncertainty.object_error, own->task.tolerance_px);
}

/* Doubts an object outside of the points' extent: nothing was checked there, whatever the
 * deviations say. */
static void judge_reach(struct camera_solution *solution)
{
	const struct camera_private *own = solution->own;
	const struct camera_problem *problem = &own->problem;
	double px[2], middle[2] = {0, 0}, here[2], reach = 0, far;

	if (!camera_sees(own, own->object, px))
		return;
	for (int i = 0; i < problem->count; i++)
		for (int k = 0; k < 2; k++)
			middle[k] += problem->point[i].px[k] / problem->count;
	for (int k = 0; k < 2; k++)
		here[k] = px[k] - middle[k];
	far = hypot(here[0], here[1]);
	for (int i = 0; i < problem->count; i++)
		if (far > 0)
			reach = fmax(reach, ((problem->point[i].px[0] - middle[0]) * here[0] +
					     (problem->point[i].px[1] - middle[1]) * here[1]) /
						    far);
	if (far > BEYOND_MOST * reach)
		verdict_doubt(
			&solution->finding.verdict,
			"put points, or the board, where the object will stand",
			"the object's place is outside of what the points cover: it is seen at %.0f, %.0f px",
			px[0], px[1]);
}

void camera_judge(struct camera_solution *solution)
{
	camera_judge_points(solution);
	judge_guess(solution);
	judge_fit(solution);
	if (!solution->solved)
		return;
	judge_views(solution);
	judge_outliers(solution);
	judge_side(solution);
	judge_fold(solution);
	judge_radial(solution);
	judge_structure(solution);
	judge_focal(solution);
	camera_judge_coverage(solution);
	judge_object(solution);
	judge_reach(solution);
}
