/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/fisheye/fisheye_knowledge.h"

#include <math.h>
#include <string.h>

#include "hal/optics/vec.h"

enum { RINGS = 16, SECTORS = 24 }; /* grid of directions in which errors are computed */

void knowledge_begin(struct lens_knowledge *knowledge, const struct optics *optics,
		     const double rotation[9])
{
	*knowledge = (struct lens_knowledge){.lens = {.optics = *optics}};
	memcpy(knowledge->lens.rotation, rotation, sizeof(knowledge->lens.rotation));
}

static bool is_in_field(const struct lens_knowledge *knowledge, const double px[2], double ray[3])
{
	return optics_ray(&knowledge->lens.optics, px, ray) &&
	       atan2(hypot(ray[0], ray[1]), ray[2]) <= knowledge->field_rad + 1e-9;
}

/* Sum of the variances of both coordinates. */
static double variance_of(const struct lens_knowledge *knowledge, const double (*gradient)[2])
{
	double variance = 0;

	for (int i = 0; i < 2; i++)
		for (int a = 0; a < KNOWLEDGE_COUNT; a++)
			for (int b = 0; b < KNOWLEDGE_COUNT; b++)
				if (gradient[a][i] != 0 && gradient[b][i] != 0)
					variance += gradient[a][i] * gradient[b][i] *
						    knowledge->covariance[a][b];
	return variance;
}

double knowledge_uncertainty(const void *context, const double px[2])
{
	const struct lens_knowledge *knowledge = context;
	double gradient[KNOWLEDGE_COUNT][2], by_point[3][2], ray[3], seen[2], variance;

	if (!is_in_field(knowledge, px, ray) ||
	    !optics_project(&knowledge->lens.optics, ray, seen, gradient, by_point))
		return -1;
	for (int k = 0; k < 3; k++) {
		const double axis[3] = {k == 0, k == 1, k == 2};
		double moved[3];

		vec_cross(axis, ray, moved);
		for (int i = 0; i < 2; i++)
			gradient[OPTICS_COUNT + k][i] = by_point[0][i] * moved[0] +
							by_point[1][i] * moved[1] +
							by_point[2][i] * moved[2];
	}
	variance = variance_of(knowledge, gradient);
	return isfinite(variance) ? sqrt(fmax(variance, 0)) : INFINITY;
}

static bool is_in_picture(const struct lens_knowledge *knowledge, const double px[2])
{
	return !knowledge->width || (px[0] >= 0 && px[1] >= 0 && px[0] <= knowledge->width &&
				     px[1] <= knowledge->height);
}

/* Angle that a pixel covers, along its longer side, degrees. */
static double pixel_deg(const struct lens_knowledge *knowledge, const double ray[3])
{
	double by_point[3][2], px[2], least = INFINITY;

	if (!optics_project(&knowledge->lens.optics, ray, px, NULL, by_point))
		return 0;
	for (int i = 0; i < 2; i++)
		least = fmin(least, sqrt(by_point[0][i] * by_point[0][i] +
					 by_point[1][i] * by_point[1][i] +
					 by_point[2][i] * by_point[2][i]));
	return 180 / M_PI / least;
}

struct circle_errors knowledge_errors(const struct lens_knowledge *knowledge)
{
	struct circle_errors errors = {.mean_px = 0};
	int count = 0;

	for (int k = 0; k <= RINGS * SECTORS; k++) {
		const double theta = knowledge->field_rad * (k ? 1 + (k - 1) / SECTORS : 0) /
				     RINGS * (1 - 1e-9);
		const double phi = 2 * M_PI * (k % SECTORS) / SECTORS;
		const double ray[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
		double px[2], error;

		if (!optics_project(&knowledge->lens.optics, ray, px, NULL, NULL)) {
			errors.mean_px = errors.most_px = errors.most_deg = INFINITY;
			return errors;
		}
		if (!is_in_picture(knowledge, px))
			continue;
		error = knowledge_uncertainty(knowledge, px);
		errors.mean_px += error;
		errors.most_px = fmax(errors.most_px, error);
		errors.most_deg = fmax(errors.most_deg, error * pixel_deg(knowledge, ray));
		count++;
	}
	errors.mean_px /= count > 0 ? count : 1;
	return errors;
}

double knowledge_angle_deg(const struct lens_knowledge *knowledge, const double px[2])
{
	double ray[3];

	if (!optics_ray(&knowledge->lens.optics, px, ray))
		return NAN;
	return atan2(hypot(ray[0], ray[1]), ray[2]) * (180 / M_PI);
}

void knowledge_publish(const struct lens_knowledge *knowledge, struct finding *finding)
{
	const struct circle_errors errors = knowledge_errors(knowledge);

	finding->context = knowledge;
	finding->uncertainty = knowledge_uncertainty;
	finding_add(finding, "circle_mean_px",
		    "mean error over the image circle, one standard deviation", "px",
		    errors.mean_px);
	finding_add(finding, "circle_most_px",
		    "largest error over the image circle, one standard deviation", "px",
		    errors.most_px);
	finding_add(finding, "circle_most_deg", "the largest, on the sky", "deg", errors.most_deg);
}
