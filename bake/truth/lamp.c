/* SPDX-License-Identifier: MIT */
#include "bake/truth/lamp.h"

/* Share of the directions from origin that meet the lamp: (1 - cos(angle)) / 2, where
 * sin(angle) = radius / distance, without loss of digits for small angles. */
static float lamp_share(const struct truth_lamp *lamp, struct v3 origin)
{
	const struct v3 way = v3_sub(lamp->centre, origin);
	const float sin2 = lamp->radius * lamp->radius / v3_dot(way, way);

	return sin2 < 1 ? sin2 / (1 + sqrtf(1 - sin2)) / 2 : 1;
}

double lamp_angle(const struct truth_lamp *lamp, struct v3 origin)
{
	return 2 * asin(sqrt((double)lamp_share(lamp, origin)));
}

float lamp_density(const struct truth_lamp *lamp, struct v3 origin)
{
	return 1 / (4 * PI_F * lamp_share(lamp, origin));
}

struct v3 lamp_sample(const struct truth_lamp *lamp, struct v3 origin, float u, float v)
{
	const struct v3 axis = v3_unit(v3_sub(lamp->centre, origin));
	const float below = 2 * u * lamp_share(lamp, origin); /* 1 - cos */
	const float sine = sqrtf(below * (2 - below));
	struct v3 s, t;

	v3_frame(axis, &s, &t);
	return v3_from_frame(
		v3_make(sine * cosf(2 * PI_F * v), sine * sinf(2 * PI_F * v), 1 - below), s, t,
		axis);
}

float lamp_distance(const struct truth_lamp *lamp, struct v3 origin, struct v3 direction)
{
	const struct v3 way = v3_sub(lamp->centre, origin);
	const float along = v3_dot(way, direction);
	const struct v3 aside = v3_mad(way, -along, direction);
	const float half = sqrtf(lamp->radius * lamp->radius - v3_dot(aside, aside));
	const float at = along > half ? along - half : along + half;

	/* half and at are NaN where the ray misses the sphere: the comparison is false then */
	return at >= 0 && origin.z + at * direction.z >= 0 ? at : INFINITY;
}
