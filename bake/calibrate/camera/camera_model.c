/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/camera/camera_model.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "bake/calibrate/estimate/rotation.h"
#include "hal/optics/vec.h"

void model_turn(struct model_view *view, const double *of_view)
{
	rotation_from_vector(of_view + MODEL_ROTATION, view->rotation, view->slope);
	memcpy(view->translation, of_view + MODEL_TRANSLATION, sizeof(view->translation));
}

/* Factor from undistorted to distorted sensor coordinates, its derivative by the squared radius
 * that it is applied to, and its derivative by kappa1. */
struct distortion {
	double factor, by_square, by_kappa;
};

static bool distortion_at(const struct camera_model *model, double kappa, double square,
			  struct distortion *d)
{
	double radius, bent, steep;

	if (model->distortion == TSAI_DISTORTS) {
		*d = (struct distortion){1 + kappa * square, kappa, square};
		return sqrt(square) <= tsai_fold_radius(kappa);
	}
	if (tsai_straight_radius(kappa, sqrt(square), &radius) < 0)
		return false;
	/* radius (1 + kappa radius^2) = sqrt(square); factor = 1 / (1 + kappa radius^2) */
	bent = 1 + kappa * radius * radius;
	steep = 1 + 3 * kappa * radius * radius;
	if (!(steep > DBL_EPSILON))
		return false;
	d->factor = 1 / bent;
	d->by_square = -kappa / (bent * bent * bent * steep);
	d->by_kappa = -radius * radius / (bent * steep);
	return true;
}

/* Derivatives of px by a point in camera axes. */
static void slope_by_place(const double *shared, const double pixel[2], const double p[3],
			   const struct distortion *d, double x, double y, double slope[2][3])
{
	const double f = shared[MODEL_FOCAL];
	const double mixed = 2 * d->by_square * x * y;
	/* derivatives of distorted by undistorted sensor coordinates */
	const double bend[2][2] = {{d->factor + 2 * d->by_square * x * x, mixed},
				   {mixed, d->factor + 2 * d->by_square * y * y}};
	const double per[2] = {shared[MODEL_ASPECT] / pixel[0], 1 / pixel[1]};

	for (int i = 0; i < 2; i++) {
		slope[i][0] = per[i] * bend[i][0] * f / p[2];
		slope[i][1] = per[i] * bend[i][1] * f / p[2];
		slope[i][2] = -per[i] * (bend[i][0] * x + bend[i][1] * y) / p[2];
	}
}

bool model_see(const struct camera_model *model, const double *shared,
	       const struct model_view *view, const double place[3], double px[2],
	       double gradient[2][MODEL_GRADIENT])
{
	const double f = shared[MODEL_FOCAL], s = shared[MODEL_ASPECT];
	double p[3], x, y, slope[2][3];
	struct distortion d;

	mat_apply(view->rotation, place, p);
	for (int i = 0; i < 3; i++)
		p[i] += view->translation[i];
	if (!(p[2] > 0) || !(f > 0) || !(s > 0))
		return false;
	x = f * p[0] / p[2];
	y = f * p[1] / p[2];
	if (!distortion_at(model, shared[MODEL_KAPPA1], x * x + y * y, &d))
		return false;
	px[0] = shared[MODEL_CENTRE_X] + s * x * d.factor / model->pixel[0];
	px[1] = shared[MODEL_CENTRE_Y] + y * d.factor / model->pixel[1];
	if (!gradient)
		return true;
	slope_by_place(shared, model->pixel, p, &d, x, y, slope);
	for (int i = 0; i < 2; i++) {
		const double unit = i ? y / model->pixel[1] : s * x / model->pixel[0];
		double *g = gradient[i];

		/* the sensor scales with f: d / df = -(p.z / f) d / dz */
		g[MODEL_FOCAL] = -slope[i][2] * p[2] / f;
		g[MODEL_KAPPA1] = unit * d.by_kappa;
		g[MODEL_CENTRE_X] = i == 0;
		g[MODEL_CENTRE_Y] = i == 1;
		g[MODEL_ASPECT] = i ? 0 : x * d.factor / model->pixel[0];
		for (int k = 0; k < 3; k++) {
			double turned[3];

			mat_apply(view->slope[k], place, turned);
			g[MODEL_SHARED + MODEL_ROTATION + k] = vec_dot(slope[i], turned);
			g[MODEL_SHARED + MODEL_TRANSLATION + k] = slope[i][k];
		}
	}
	return true;
}

bool model_straighten(const struct camera_model *model, const double *shared, const double px[2],
		      double sensor[2])
{
	const double kappa = shared[MODEL_KAPPA1];
	const double x = (px[0] - shared[MODEL_CENTRE_X]) * model->pixel[0] / shared[MODEL_ASPECT];
	const double y = (px[1] - shared[MODEL_CENTRE_Y]) * model->pixel[1];
	const double radius = hypot(x, y);
	double factor = 1 + kappa * radius * radius, straight;

	if (model->distortion == TSAI_DISTORTS) {
		if (tsai_straight_radius(kappa, radius, &straight) < 0)
			return false;
		factor = radius > 0 ? straight / radius : 1;
	} else if (!(radius <= tsai_fold_radius(kappa))) {
		return false;
	}
	sensor[0] = x * factor;
	sensor[1] = y * factor;
	return true;
}

bool model_place(const struct camera_model *model, const double *shared,
		 const struct model_view *view, const double px[2], double depth, double place[3])
{
	double sensor[2], p[3];

	if (!model_straighten(model, shared, px, sensor))
		return false;
	p[0] = sensor[0] / shared[MODEL_FOCAL] * depth - view->translation[0];
	p[1] = sensor[1] / shared[MODEL_FOCAL] * depth - view->translation[1];
	p[2] = depth - view->translation[2];
	mat_apply_transposed(view->rotation, p, place);
	return true;
}
