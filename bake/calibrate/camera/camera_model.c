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

/* Distorted sensor coordinates, their derivatives by the undistorted ones (xx, xy, yy), and by each
 * kappa. */
struct distorted {
	double at[2], slope[3], by_kappa[MODEL_RADIAL][2];
};

static struct distortion distortion_of(const struct camera_model *model, const double *shared)
{
	struct distortion d = {.tangential = {model->tangential[0], model->tangential[1]},
			       .reach = model->reach};

	memcpy(d.radial, shared + MODEL_KAPPA1, sizeof(d.radial));
	return d;
}

/*
 * With bent = F(p) and F's Jacobian J at p, which is symmetric:
 *     d bent / d kappa_k = p |p|^(2 k)                      p is undistorted
 *     d p / d bent = J^-1,   d p / d kappa_k = -J^-1 p |p|^(2 k)   p is distorted
 */
static bool distort(const struct camera_model *model, const double *shared,
		    const double straight[2], struct distorted *d)
{
	const struct distortion own = distortion_of(model, shared);
	double bent[2], j[3], p[2] = {straight[0], straight[1]}, power = 1, determinant;

	if (model->distortion == TSAI_DISTORTS) {
		if (distortion_bend(&own, p, d->at, d->slope) < 0)
			return false;
	} else {
		if (distortion_straighten(&own, straight, p) < 0 ||
		    distortion_bend(&own, p, bent, j) < 0)
			return false;
		determinant = j[0] * j[2] - j[1] * j[1];
		if (!(determinant > DBL_EPSILON))
			return false;
		memcpy(d->at, p, sizeof(d->at));
		d->slope[0] = j[2] / determinant;
		d->slope[1] = -j[1] / determinant;
		d->slope[2] = j[0] / determinant;
	}
	for (int k = 0; k < MODEL_RADIAL; k++) {
		double by[2];

		power *= p[0] * p[0] + p[1] * p[1];
		for (int i = 0; i < 2; i++)
			by[i] = d->by_kappa[k][i] = p[i] * power;
		if (model->distortion == TSAI_DISTORTS)
			continue;
		for (int i = 0; i < 2; i++)
			d->by_kappa[k][i] = -(d->slope[i] * by[0] + d->slope[i + 1] * by[1]);
	}
	return true;
}

/* Derivatives of px by a point in camera axes. */
static void slope_by_place(const double *shared, const double pixel[2], const double p[3],
			   const struct distorted *d, const double straight[2], double slope[2][3])
{
	const double f = shared[MODEL_FOCAL];
	const double per[2] = {shared[MODEL_ASPECT] / pixel[0], 1 / pixel[1]};

	for (int i = 0; i < 2; i++) {
		const double *bend = d->slope + i; /* row i of a symmetric matrix */

		slope[i][0] = per[i] * bend[0] * f / p[2];
		slope[i][1] = per[i] * bend[1] * f / p[2];
		slope[i][2] = -per[i] * (bend[0] * straight[0] + bend[1] * straight[1]) / p[2];
	}
}

bool model_see(const struct camera_model *model, const double *shared,
	       const struct model_view *view, const double place[3], double px[2],
	       double gradient[2][MODEL_GRADIENT])
{
	const double f = shared[MODEL_FOCAL], s = shared[MODEL_ASPECT];
	double p[3], straight[2], slope[2][3];
	struct distorted d;

	mat_apply(view->rotation, place, p);
	for (int i = 0; i < 3; i++)
		p[i] += view->translation[i];
	if (!(p[2] > 0) || !(f > 0) || !(s > 0))
		return false;
	straight[0] = f * p[0] / p[2];
	straight[1] = f * p[1] / p[2];
	if (!distort(model, shared, straight, &d))
		return false;
	px[0] = shared[MODEL_CENTRE_X] + s * d.at[0] / model->pixel[0];
	px[1] = shared[MODEL_CENTRE_Y] + d.at[1] / model->pixel[1];
	if (!gradient)
		return true;
	slope_by_place(shared, model->pixel, p, &d, straight, slope);
	for (int i = 0; i < 2; i++) {
		const double unit = (i ? 1 : s) / model->pixel[i];
		double *g = gradient[i];

		/* the sensor scales with f: d / df = -(p.z / f) d / dz */
		g[MODEL_FOCAL] = -slope[i][2] * p[2] / f;
		for (int k = 0; k < MODEL_RADIAL; k++)
			g[MODEL_KAPPA1 + k] = unit * d.by_kappa[k][i];
		g[MODEL_CENTRE_X] = i == 0;
		g[MODEL_CENTRE_Y] = i == 1;
		g[MODEL_ASPECT] = i ? 0 : d.at[0] / model->pixel[0];
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
	const struct distortion d = distortion_of(model, shared);
	const double at[2] = {(px[0] - shared[MODEL_CENTRE_X]) * model->pixel[0] /
				      shared[MODEL_ASPECT],
			      (px[1] - shared[MODEL_CENTRE_Y]) * model->pixel[1]};

	if (model->distortion == TSAI_DISTORTS)
		return distortion_straighten(&d, at, sensor) == 0;
	return distortion_bend(&d, at, sensor, NULL) == 0;
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
