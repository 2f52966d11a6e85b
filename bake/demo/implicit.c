/* SPDX-License-Identifier: MIT */
#include "bake/demo/implicit.h"

#include <stdbool.h>
#include <string.h>

#include "hal/optics/vec.h"

#define DEGREE (M_PI / 180)

/* Rows of the rotation about x, then y, then z: its transpose takes world to the shape's axes. */
static void turn_matrix(const double turn_deg[3], double m[9])
{
	const double cx = cos(turn_deg[0] * DEGREE), sx = sin(turn_deg[0] * DEGREE);
	const double cy = cos(turn_deg[1] * DEGREE), sy = sin(turn_deg[1] * DEGREE);
	const double cz = cos(turn_deg[2] * DEGREE), sz = sin(turn_deg[2] * DEGREE);

	m[0] = cz * cy;
	m[1] = cz * sy * sx - sz * cx;
	m[2] = cz * sy * cx + sz * sx;
	m[3] = sz * cy;
	m[4] = sz * sy * sx + cz * cx;
	m[5] = sz * sy * cx - cz * sx;
	m[6] = -sy;
	m[7] = cy * sx;
	m[8] = cy * cx;
}

/*
 * k0 (k0 - 1) / k1 with k0 = |q / r| and k1 = |q / r^2|: zero on the surface with a gradient of
 * length 1 there, and near to the distance around it. At the very centre, where the quotient is
 * 0/0, the smallest radius stands for it.
 */
struct implicit implicit_ellipsoid(const struct ellipsoid *shape, const double p[3])
{
	const bool turned = shape->turn_deg[0] || shape->turn_deg[1] || shape->turn_deg[2];
	double m[9], q[3], k0 = 0, k1 = 0, local[3];
	struct implicit out;

	for (int i = 0; i < 3; i++)
		q[i] = p[i] - shape->centre[i];
	if (turned) {
		turn_matrix(shape->turn_deg, m);
		mat_apply_transposed(m, q, q);
	}
	for (int i = 0; i < 3; i++) {
		const double r2 = shape->radius[i] * shape->radius[i];

		k0 += q[i] * q[i] / r2;
		k1 += q[i] * q[i] / (r2 * r2);
	}
	k0 = sqrt(k0);
	k1 = sqrt(k1);
	if (k0 < 1e-9) {
		out = (struct implicit){
			.value = -fmin(fmin(shape->radius[0], shape->radius[1]), shape->radius[2])};
		return out;
	}
	for (int i = 0; i < 3; i++) {
		const double r2 = shape->radius[i] * shape->radius[i];
		const double dk0 = q[i] / (r2 * k0);
		const double dk1 = q[i] / (r2 * r2 * k1);

		local[i] = ((2 * k0 - 1) * dk0 * k1 - k0 * (k0 - 1) * dk1) / (k1 * k1);
	}
	out.value = k0 * (k0 - 1) / k1;
	if (turned)
		mat_apply(m, local, out.gradient);
	else
		memcpy(out.gradient, local, sizeof(local));
	return out;
}

/*
 * The distance is the least of |p - c(s)| - r(s) over the axis, a convex function of s whose
 * minimum is known in closed form; at a minimum the gradient is that of |p - c| alone.
 */
struct implicit implicit_round_cone(const struct round_cone *shape, const double p[3])
{
	double axis[3], q[3], along, across, slope, s;
	struct implicit out;

	for (int i = 0; i < 3; i++) {
		axis[i] = shape->end[1][i] - shape->end[0][i];
		q[i] = p[i] - shape->end[0][i];
	}
	const double length = vec_normalize(axis);

	along = vec_dot(q, axis);
	across = sqrt(fmax(0, vec_dot(q, q) - along * along));
	slope = (shape->radius[1] - shape->radius[0]) / length;
	s = along + across * slope / sqrt(1 - slope * slope);
	s = fmin(fmax(s, 0), length);
	for (int i = 0; i < 3; i++)
		out.gradient[i] = q[i] - s * axis[i];
	out.value = vec_normalize(out.gradient) - (shape->radius[0] + slope * s);
	return out;
}

/* across: pseudo-distance from the ellipse in its plane, by the ellipsoid's formula; q[1]: height
 * above that plane. The tube is an ellipse in these two. */
struct implicit implicit_ring(const struct ring *shape, const double p[3])
{
	const double turn_deg[3] = {shape->tilt_deg, 0, 0};
	double m[9], q[3], plane[2], local[3];
	double k0, k1, across, reach;
	struct implicit out = {.value = 0};

	turn_matrix(turn_deg, m);
	for (int i = 0; i < 3; i++)
		q[i] = p[i] - shape->centre[i];
	mat_apply_transposed(m, q, q);

	const double a2 = shape->radius[0] * shape->radius[0];
	const double b2 = shape->radius[1] * shape->radius[1];

	k0 = sqrt(q[0] * q[0] / a2 + q[2] * q[2] / b2);
	k1 = sqrt(q[0] * q[0] / (a2 * a2) + q[2] * q[2] / (b2 * b2));
	if (k0 < 1e-9) {
		out.value = fmin(shape->radius[0], shape->radius[1]);
		return out;
	}
	across = k0 * (k0 - 1) / k1;
	for (int i = 0; i < 2; i++) {
		const double r2 = i ? b2 : a2;
		const double x = q[2 * i];

		plane[i] =
			((2 * k0 - 1) * x / (r2 * k0) * k1 - k0 * (k0 - 1) * x / (r2 * r2 * k1)) /
			(k1 * k1);
	}
	const double u = across / shape->tube[0], v = q[1] / shape->tube[1];
	const double thin = fmin(shape->tube[0], shape->tube[1]);

	reach = sqrt(u * u + v * v);
	if (reach < 1e-9) {
		out.value = -thin;
		return out;
	}
	out.value = (reach - 1) * thin;
	local[0] = thin * u / reach / shape->tube[0] * plane[0];
	local[1] = thin * v / reach / shape->tube[1];
	local[2] = thin * u / reach / shape->tube[0] * plane[1];
	mat_apply(m, local, out.gradient);
	return out;
}

struct implicit implicit_above(double height, const double p[3])
{
	return (struct implicit){.value = height - p[1], .gradient = {0, -1, 0}};
}

static struct implicit implicit_negative(struct implicit a)
{
	a.value = -a.value;
	for (int i = 0; i < 3; i++)
		a.gradient[i] = -a.gradient[i];
	return a;
}

/* min(a, b) - h^3 width / 6 with h = max(0, 1 - |a - b| / width). */
struct implicit implicit_union(struct implicit a, struct implicit b, double width)
{
	const struct implicit *low = a.value < b.value ? &a : &b;
	const struct implicit *high = low == &a ? &b : &a;
	const double h = fmax(0, 1 - (high->value - low->value) / width);
	struct implicit out;

	out.value = low->value - h * h * h * width / 6;
	for (int i = 0; i < 3; i++)
		out.gradient[i] = low->gradient[i] +
				  h * h / 2 * (high->gradient[i] - low->gradient[i]);
	return out;
}

struct implicit implicit_intersection(struct implicit a, struct implicit b, double width)
{
	return implicit_negative(implicit_union(implicit_negative(a), implicit_negative(b), width));
}

struct implicit implicit_difference(struct implicit a, struct implicit b, double width)
{
	return implicit_intersection(a, implicit_negative(b), width);
}
