/* SPDX-License-Identifier: MIT */
/*
 * Lamps at places: spheres of the same radiance all around, inside as well. They shine through each
 * other and block no light. What of them is below the ground, Z < 0, does not shine.
 */
#ifndef INLAY_BAKE_TRUTH_LAMP_H
#define INLAY_BAKE_TRUTH_LAMP_H

#include "bake/base/vec3.h"

struct truth_lamp {
	struct v3 centre; /* world units, as radius */
	float radius;	  /* > 0 */
	struct rgb radiance;
};

/* The angle between the directions from origin to the lamp's centre and to its rim. */
double lamp_angle(const struct truth_lamp *lamp, struct v3 origin);

/* The probability density, per sr, with which lamp_sample() draws each direction from origin to the
 * lamp; of all directions if origin is within it. */
float lamp_density(const struct truth_lamp *lamp, struct v3 origin);

/* Draws a direction from two numbers u, v in [0, 1), uniform over the solid angle of the lamp. */
struct v3 lamp_sample(const struct truth_lamp *lamp, struct v3 origin, float u, float v);

/* The distance at which a ray (unit direction) meets the lamp; INFINITY: it does not. */
float lamp_distance(const struct truth_lamp *lamp, struct v3 origin, struct v3 direction);

#endif
