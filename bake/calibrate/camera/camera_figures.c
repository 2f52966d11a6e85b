/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/camera/camera_parts.h"
#include "hal/optics/vec.h"

static void place_from_middle(const struct camera_private *own, const double world[3],
			      double place[3])
{
	for (int k = 0; k < 3; k++)
		place[k] = world[k] - own->problem.shape[own->task.reference].middle[k];
}

static void turn_reference(const struct camera_private *own, const double *x,
			   struct model_view *view)
{
	model_turn(view, x + model_of_view(own->task.reference));
}

/* Index among all unknowns of element k of a gradient. */
static int unknown_of(const struct camera_private *own, int k)
{
	return k < MODEL_SHARED ? k : model_of_view(own->task.reference) + k - MODEL_SHARED;
}

/* spread = G C G^T, for a gradient by the shared unknowns and the reference view's. */
static bool propagate_to_px(const struct camera_private *own, const double *covariance,
			    double gradient[2][MODEL_GRADIENT], double spread[3])
{
	const int n = problem_unknowns(&own->problem);

	spread[0] = spread[1] = spread[2] = 0;
	for (int a = 0; a < MODEL_GRADIENT; a++)
		for (int b = 0; b < MODEL_GRADIENT; b++) {
			const double c = covariance[unknown_of(own, a) * n + unknown_of(own, b)];

			if (isinf(c)) /* unknown: fine if the point does not depend on it */
				if (gradient[0][a] == 0 && gradient[1][a] == 0)
					continue;
			spread[0] += gradient[0][a] * c * gradient[0][b];
			spread[1] += gradient[0][a] * c * gradient[1][b];
			spread[2] += gradient[1][a] * c * gradient[1][b];
		}
	return isfinite(spread[0]) && isfinite(spread[1]) && isfinite(spread[2]);
}

bool camera_spread(const struct camera_private *own, const double *covariance,
		   const double world[3], double spread[3])
{
	double place[3], px[2], gradient[2][MODEL_GRADIENT];
	struct model_view view;

	place_from_middle(own, world, place);
	turn_reference(own, own->x, &view);
	return model_see(&own->problem.model, own->x, &view, place, px, gradient) &&
	       propagate_to_px(own, covariance, gradient, spread);
}

bool camera_sees(const struct camera_private *own, const double world[3], double px[2])
{
	double place[3];
	struct model_view view;

	place_from_middle(own, world, place);
	turn_reference(own, own->x, &view);
	return model_see(&own->problem.model, own->x, &view, place, px, NULL);
}

double camera_spread_length(const double spread[3])
{
	const double half = (spread[0] - spread[2]) / 2;

	return sqrt(fmax(0, (spread[0] + spread[2]) / 2 + hypot(half, spread[1])));
}

/* Whether px is in the picture, as far as its size is known. */
static bool in_picture(const struct camera_private *own, const double px[2])
{
	return !own->task.width ||
	       (px[0] >= 0 && px[0] <= own->task.width && px[1] >= 0 && px[1] <= own->task.height);
}

double camera_object_error(const struct camera_private *own, const double *covariance)
{
	double worst = 0;

	for (int k = 0; k < 7; k++) {
		double world[3], spread[3], px[2];

		memcpy(world, own->object, sizeof(world));
		if (k)
			world[(k - 1) / 2] += k % 2 ? own->radius : -own->radius;
		if (k && (!camera_sees(own, world, px) || !in_picture(own, px)))
			continue;
		if (!camera_spread(own, covariance, world, spread))
			return INFINITY;
		worst = fmax(worst, camera_spread_length(spread));
	}
	return worst;
}

double camera_uncertainty(const void *context, const double px[2])
{
	const struct camera_private *own = context;
	double place[3], again[2], gradient[2][MODEL_GRADIENT], spread[3];
	struct model_view view;

	turn_reference(own, own->x, &view);
	if (!model_place(&own->problem.model, own->x, &view, px, own->depth, place) ||
	    !model_see(&own->problem.model, own->x, &view, place, again, gradient))
		return -1;
	return propagate_to_px(own, own->uncertainty.covariance, gradient, spread)
		       ? camera_spread_length(spread)
		       : INFINITY;
}

bool camera_project_view(const void *context, int view, const double world[3], double px[2])
{
	const struct camera_private *own = context;
	struct model_view turned;
	double place[3];

	for (int k = 0; k < 3; k++)
		place[k] = world[k] - own->problem.shape[view].middle[k];
	model_turn(&turned, own->x + model_of_view(view));
	return model_see(&own->problem.model, own->x, &turned, place, px, NULL);
}

/* ---- errors of the points ---- */

/* Sums over the inliers. */
struct figure_errors {
	int count;
	double distorted, distorted_most;     /* px */
	double undistorted, undistorted_most; /* px */
	double object, object_most;	      /* world units */
	double normalised;
};

static void figures_add(double value, double *sum, double *most)
{
	*sum += value;
	*most = fmax(*most, value);
}

/*
 * Adds one point. Object space error: distance of the observed ray from the point. Normalised error
 * (Weng, Cohen and Herniou 1992, 24): the error in the plane of the point's depth, relative to the
 * error from rounding to whole pixels,
 *     depth sqrt((fu^-2 + fv^-2) / 12)
 */
static void figures_add_point(const struct camera_private *own, int i,
			      const struct model_view *view, const double px[2],
			      struct figure_errors *sum)
{
	const double *x = own->x, *pixel = own->problem.model.pixel;
	const struct observation *point = &own->problem.point[i];
	double p[3], sensor[2], ray[3], off[3], at[2], normal = 0;

	mat_apply(view->rotation, own->problem.place[i], p);
	for (int k = 0; k < 3; k++)
		p[k] += view->translation[k];
	figures_add(hypot(px[0] - point->px[0], px[1] - point->px[1]), &sum->distorted,
		    &sum->distorted_most);
	sum->count++;
	if (!model_straighten(&own->problem.model, x, point->px, sensor))
		return;
	for (int k = 0; k < 2; k++)
		at[k] = sensor[k] - x[MODEL_FOCAL] * p[k] / p[2];
	figures_add(hypot(at[0] * x[MODEL_ASPECT] / pixel[0], at[1] / pixel[1]), &sum->undistorted,
		    &sum->undistorted_most);
	for (int k = 0; k < 2; k++) {
		const double in_plane = at[k] * p[2] / x[MODEL_FOCAL];
		const double unit = pixel[k] / x[MODEL_FOCAL] / (k ? 1 : x[MODEL_ASPECT]);

		normal += unit * unit;
		off[k] = in_plane;
	}
	sum->normalised += hypot(off[0], off[1]) / (p[2] * sqrt(normal / 12));
	ray[0] = sensor[0];
	ray[1] = sensor[1];
	ray[2] = x[MODEL_FOCAL];
	vec_normalize(ray);
	vec_cross(ray, p, off);
	figures_add(vec_length(off), &sum->object, &sum->object_most);
}

static void figures_measure(struct camera_solution *solution, struct figure_errors *sum)
{
	const struct camera_private *own = solution->own;
	struct finding *finding = &solution->finding;
	struct model_view turned;
	double squares = 0;

	*sum = (struct figure_errors){0};
	for (int v = 0; v < own->problem.views; v++) {
		model_turn(&turned, own->x + model_of_view(v));
		for (int i = own->problem.first[v]; i < own->problem.first[v + 1]; i++) {
			if (isnan(finding->expected[i][0]) || finding->weight[i] < 0.1)
				continue;
			figures_add_point(own, i, &turned, finding->expected[i], sum);
		}
	}
	for (int i = 0; i < own->problem.count; i++)
		if (finding->weight[i] >= 0.1 && !isnan(finding->expected[i][0])) {
			const double dx = finding->expected[i][0] - own->problem.point[i].px[0];
			const double dy = finding->expected[i][1] - own->problem.point[i].px[1];

			squares += dx * dx + dy * dy;
		}
	finding->rms_px = sum->count ? sqrt(squares / sum->count) : 0;
	finding->worst_px = sum->distorted_most;
}

/* Uncertainty, in mm, of the place on the ground (Z = 0) under the object that a pixel shows: the
 * covariance in the picture, propagated through the inverse of d px / d (X, Y). Negative: the
 * ground there has no image, or is seen edge-on. */
static double ground_error(const struct camera_private *own)
{
	const double world[3] = {own->object[0], own->object[1], 0};
	double place[3], px[2], gradient[2][MODEL_GRADIENT], spread[3], by[2][2], determinant;
	double on_ground[3];
	struct model_view view;

	place_from_middle(own, world, place);
	turn_reference(own, own->x, &view);
	if (!model_see(&own->problem.model, own->x, &view, place, px, gradient) ||
	    !propagate_to_px(own, own->uncertainty.cautious, gradient, spread))
		return -1;
	for (int i = 0; i < 2; i++)
		for (int k = 0; k < 2; k++) /* a step of the world is a step of T, rotated */
			by[i][k] = gradient[i][MODEL_SHARED + MODEL_TRANSLATION] *
					   view.rotation[k] +
				   gradient[i][MODEL_SHARED + MODEL_TRANSLATION + 1] *
					   view.rotation[3 + k] +
				   gradient[i][MODEL_SHARED + MODEL_TRANSLATION + 2] *
					   view.rotation[6 + k];
	determinant = by[0][0] * by[1][1] - by[0][1] * by[1][0];
	if (!(fabs(determinant) > 0))
		return -1;
	on_ground[0] = (by[1][1] * by[1][1] * spread[0] - 2 * by[1][1] * by[0][1] * spread[1] +
			by[0][1] * by[0][1] * spread[2]) /
		       (determinant * determinant);
	on_ground[2] = (by[1][0] * by[1][0] * spread[0] - 2 * by[1][0] * by[0][0] * spread[1] +
			by[0][0] * by[0][0] * spread[2]) /
		       (determinant * determinant);
	on_ground[1] = (-by[1][1] * by[1][0] * spread[0] +
			(by[1][1] * by[0][0] + by[0][1] * by[1][0]) * spread[1] -
			by[0][1] * by[0][0] * spread[2]) /
		       (determinant * determinant);
	return camera_spread_length(on_ground) * own->task.unit_mm;
}

static void figures_of_points(struct finding *finding, const struct figure_errors *sum,
			      double unit_mm)
{
	const double n = sum->count ? sum->count : 1;

	finding_add(finding, "normalised_calibration_error",
		    "normalised calibration error: 1 is what rounding to pixels would make", "",
		    sum->normalised / n);
	finding_add(finding, "distorted_error_mean", "distorted image error, mean", "px",
		    sum->distorted / n);
	finding_add(finding, "distorted_error_max", "distorted image error, largest", "px",
		    sum->distorted_most);
	finding_add(finding, "undistorted_error_mean", "undistorted image error, mean", "px",
		    sum->undistorted / n);
	finding_add(finding, "undistorted_error_max", "undistorted image error, largest", "px",
		    sum->undistorted_most);
	finding_add(finding, "object_space_error_mean", "distance of rays from their points, mean",
		    "mm", sum->object / n * unit_mm);
	finding_add(finding, "object_space_error_max",
		    "distance of rays from their points, largest", "mm",
		    sum->object_most * unit_mm);
}

void camera_figures(struct camera_solution *solution)
{
	const struct camera_private *own = solution->own;
	struct finding *finding = &solution->finding;
	const int focal = estimate_find(&finding->estimate, "focal");
	const int depth = model_of_view(own->task.reference) + MODEL_TRANSLATION + 2;
	struct camera_structure structure;
	struct figure_errors sum;
	double ground;
	int outliers = 0;

	figures_measure(solution, &sum);
	finding_add(finding, "object_error_px", CAMERA_OBJECT_ERROR, "px",
		    own->uncertainty.object_error);
	finding_add(finding, "object_deviation_px",
		    "standard deviation of this estimate at the object's place", "px",
		    camera_object_error(own, own->uncertainty.covariance));
	ground = ground_error(own);
	if (ground >= 0)
		finding_add(finding, "ground_error_mm",
			    "uncertainty on the ground under the object", "mm", ground);
	for (int k = 1; k <= MODEL_RADIAL; k++)
		if (own->left_out[k] > 0) {
			char key[32], label[96];

			snprintf(key, sizeof(key), "left_out_px_%d", k);
			snprintf(label, sizeof(label),
				 "rms of points that were left out, by %d radial term%s", k,
				 k > 1 ? "s" : "");
			finding_add(finding, key, label, "px", own->left_out[k]);
		}
	camera_find_structure(own, &structure);
	finding_add(finding, "structure_px",
		    "mean residual of a ring or part of the picture that noise explains least",
		    "px", fabs(structure.mean_px));
	finding_add(finding, "structure_sigmas", "the same, in deviations that noise makes", "",
		    structure.sigmas);
	figures_of_points(finding, &sum, own->task.unit_mm);
	finding_add(finding, "focal_depth_correlation", "correlation of f and Tz", "",
		    estimate_correlation(&finding->estimate, focal, depth));
	if (own->fit.by_view.views > 1) {
		finding_add(finding, "views_dispersion",
			    "deviations by view over deviations by points, on average", "",
			    own->fit.dispersion);
	}
	finding_add(finding, "condition", "condition of the unknowns", "", own->fit.condition);
	for (int i = 0; i < own->problem.count; i++)
		outliers += finding->weight[i] < 0.1;
	finding_add(finding, "outliers", "points left out", "", outliers);
}
