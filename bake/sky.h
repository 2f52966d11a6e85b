/*
 * A panorama as a light: its upper half, importance-sampled texel by texel. Below the horizon
 * nothing shines: what is there is the ground.
 */
#ifndef INLAY_BAKE_SKY_H
#define INLAY_BAKE_SKY_H

#include "bake/vec3.h"
#include "hal/optics/panorama.h"

struct sky {
	struct panorama panorama;
	int width, rows; /* rows that reach above the horizon */
	double *row_sum; /* [rows]: running sum over rows */
	double *sum;	 /* [rows][width]: running sum along each row */
	double total;
	struct rgb ground; /* what flat, unshadowed, white ground sends back: irradiance / pi */
};

/* The image of the panorama must outlive the sky. -EDOM: the upper half is black. */
int sky_create(struct sky *sky, const struct panorama *panorama, const char *name,
	       struct fault *fault);
void sky_free(struct sky *sky); /* idempotent; zeroed is fine */

/* Radiance from a direction; black below the horizon. */
struct rgb sky_radiance(const struct sky *sky, struct v3 direction);

/* A direction from two numbers in [0, 1), and the density with which it is drawn, per sr. */
struct v3 sky_sample(const struct sky *sky, float u, float v, float *density);
float sky_density(const struct sky *sky, struct v3 direction);

#endif
