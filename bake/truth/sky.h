/* SPDX-License-Identifier: MIT */
/*
 * The light: from afar the upper half of a panorama, importance-sampled by texel, or one light of
 * a dome, whose radiance is its weight, or nothing; and lamps at places. Nothing shines from below
 * the horizon, where the ground is.
 */
#ifndef INLAY_BAKE_TRUTH_SKY_H
#define INLAY_BAKE_TRUTH_SKY_H

#include "bake/base/vec3.h"
#include "hal/optics/dome.h"
#include "hal/optics/panorama.h"

/*
 * Lamps at places: spheres of the same radiance all around, inside as well. They shine through each
 * other and block no light. What of them is below the ground, Z < 0, does not shine.
 */

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

struct sky {
	const struct truth_lamp *lamps;
	int lamp_count;
	const struct dome *dome; /* NULL: the panorama; without an image: black */
	int light;		 /* its index in the dome */
	struct panorama panorama;
	int width, rows; /* rows that reach above the horizon */
	double *row_sum; /* [rows]: running sum over rows */
	double *sum;	 /* [rows][width]: running sum along each row */
	double total;
	struct rgb ground; /* radiance of flat, unshadowed, white ground: irradiance / pi */
};

/* Prepares a panorama for sampling, without lamps. Its image, as panorama_read() accepts it, must
 * outlive the sky. name is for faults. -ENOMEM; -EDOM: the upper half is black. */
int sky_create(struct sky *sky, const struct panorama *panorama, const char *name,
	       struct fault *fault);

/* Makes a sky of one light of a dome, which must outlive the sky. Cannot fail. */
void sky_of_light(struct sky *sky, const struct dome *dome, int light);

void sky_free(struct sky *sky); /* idempotent; zeroed is fine */

/* Radiance from afar; black below the horizon. */
struct rgb sky_radiance(const struct sky *sky, struct v3 direction);

/* Radiance of the lamps that a ray meets before the distance far. */
struct rgb sky_lamps(const struct sky *sky, struct v3 origin, struct v3 direction, float far);

/* sky_sample() draws a direction from two numbers u, v in [0, 1) for the light from afar; density
 * is its probability density, per sr, 0 if there is none. sky_density() returns the density of a
 * given direction. */
struct v3 sky_sample(const struct sky *sky, float u, float v, float *density);
float sky_density(const struct sky *sky, struct v3 direction);

#endif
