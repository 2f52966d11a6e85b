/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/camera/camera_model.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "hal/optics/vec.h"

/*
 * Rodrigues: R = I + a K + b K^2 with K = [v], t = |v|, a = sin t / t, b = (1 - cos t) / t^2. Each
 * derivative is taken term by term; da/dt / t and db/dt / t by their series near 0, where the
 * closed forms lose their digits.
 */
void rotation_from_vector(const double v[3], double rotation[9], double slope[3][9])
{
	const double tt = vec_dot(v, v), t = sqrt(tt), half = sin(t / 2);
	const bool near = t < 1e-2;
	const double a = near ? 1 - tt / 6 * (1 - tt / 20 * (1 - tt / 42)) : sin(t) / t;
	const double b = near ? 0.5 - tt / 24 * (1 - tt / 30 * (1 - tt / 56))
			      : 2 * half * half / tt;
	const double da = near ? -1.0 / 3 + tt / 30 - tt * tt / 840 : (cos(t) - a) / tt;
	const double db = near ? -1.0 / 12 + tt / 180 - tt * tt / 6720 : (a - 2 * b) / tt;

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			/* K_ij = -e_ijk v_k; (K^2)_ij = v_i v_j - tt (i == j) */
			const int k = 3 - i - j;
			const double sign = i == j ? 0 : (j - i + 3) % 3 == 1 ? -1 : 1;
			const double cross = i == j ? 0 : sign * v[k];
			const double square = v[i] * v[j] - (i == j) * tt;

			rotation[3 * i + j] = (i == j) + a * cross + b * square;
			for (int d = 0; d < 3; d++) {
				const double turn = i != j && k == d ? sign : 0;
				const double bend = (d == i) * v[j] + (d == j) * v[i] -
						    2 * (i == j) * v[d];

				slope[d][3 * i + j] = v[d] * (da * cross + db * square) + a * turn +
						      b * bend;
			}
		}
}

/* By the quaternion's largest part: no digits are lost near a half turn. */
void rotation_to_vector(const double r[9], double vector[3])
{
	const double squares[4] = {1 + r[0] + r[4] + r[8], 1 + r[0] - r[4] - r[8],
				   1 - r[0] + r[4] - r[8], 1 - r[0] - r[4] + r[8]};
	double q[4], sine, factor;
	int most = 0;

	for (int k = 1; k < 4; k++)
		if (squares[k] > squares[most])
			most = k;
	q[0] = most == 0   ? squares[0]
	       : most == 1 ? r[7] - r[5]
	       : most == 2 ? r[2] - r[6]
			   : r[3] - r[1];
	q[1] = most == 0   ? r[7] - r[5]
	       : most == 1 ? squares[1]
	       : most == 2 ? r[1] + r[3]
			   : r[2] + r[6];
	q[2] = most == 0   ? r[2] - r[6]
	       : most == 1 ? r[1] + r[3]
	       : most == 2 ? squares[2]
			   : r[5] + r[7];
	q[3] = most == 0   ? r[3] - r[1]
	       : most == 1 ? r[2] + r[6]
	       : most == 2 ? r[5] + r[7]
			   : squares[3];
	sine = vec_length(q + 1);
	if (!(sine > 0)) {
		memset(vector, 0, 3 * sizeof(*vector));
		return;
	}
	factor = 2 * atan2(q[0] < 0 ? -sine : sine, fabs(q[0])) / sine;
	for (int i = 0; i < 3; i++)
		vector[i] = factor * q[1 + i];
}

void model_turn(struct model_view *view, const double *of_view)
{
	rotation_from_vector(of_view + MODEL_ROTATION, view->rotation, view->slope);
	memcpy(view->translation, of_view + MODEL_TRANSLATION, sizeof(view->translation));
}

/* What the radius is multiplied with between undistorted and distorted sensor coordinates, its
 * slope by the squared radius it is applied to, and its slope by kappa1. */
struct distortion {
	double factor, by_square, by_kappa;
};

static bool distort(const struct camera_model *model, double kappa, double square,
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

/* Slopes of px by a point in camera axes. */
static void by_camera(const double *shared, const double pixel[2], const double p[3],
		      const struct distortion *d, double x, double y, double slope[2][3])
{
	const double f = shared[MODEL_FOCAL];
	const double mixed = 2 * d->by_square * x * y;
	/* of distorted by undistorted sensor coordinates */
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
	if (!distort(model, shared[MODEL_KAPPA1], x * x + y * y, &d))
		return false;
	px[0] = shared[MODEL_CENTRE_X] + s * x * d.factor / model->pixel[0];
	px[1] = shared[MODEL_CENTRE_Y] + y * d.factor / model->pixel[1];
	if (!gradient)
		return true;
	by_camera(shared, model->pixel, p, &d, x, y, slope);
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
