/* SPDX-License-Identifier: MIT */
/*
 * A panorama as a light: its upper half, importance-sampled texel by texel; or one light of a dome,
 * whose radiance is its weight. Below the horizon nothing shines: what is there is the ground.
 */
#ifndef INLAY_BAKE_TRUTH_SKY_H
#define INLAY_BAKE_TRUTH_SKY_H

#include "bake/base/vec3.h"
#include "hal/optics/dome.h"
#include "hal/optics/panorama.h"

struct sky {
	const struct dome *dome; /* NULL: the panorama */
	int light;		 /* of the dome */
	struct panorama panorama;
	int width, rows; /* rows that reach above the horizon */
	double *row_sum; /* [rows]: running sum over rows */
	double *sum;	 /* [rows][width]: running sum along each row */
	double total;
	struct rgb ground; /* what flat, unshadowed, white ground sends back: irradiance / pi */
};

/* The image of the panorama, as panorama_read() takes them, must outlive the sky. -EDOM: the upper
 * half is black. */
int sky_create(struct sky *sky, const struct panorama *panorama, const char *name,
	       struct fault *fault);

/* Cannot fail. The dome must outlive the sky. */
void sky_of_light(struct sky *sky, const struct dome *dome, int light);

void sky_free(struct sky *sky); /* idempotent; zeroed is fine */

/* Radiance from a direction; black below the horizon. */
struct rgb sky_radiance(const struct sky *sky, struct v3 direction);

/* A direction from two numbers in [0, 1), and the density with which it is drawn, per sr. */
struct v3 sky_sample(const struct sky *sky, float u, float v, float *density);
float sky_density(const struct sky *sky, struct v3 direction);

#endif
