/* SPDX-License-Identifier: MIT */
/*
 * Finds lamps in a fisheye's picture: spots that are small and much brighter than what is around
 * them. What is as large as a window, or shades off into its surroundings, is none.
 */
#ifndef INLAY_HAL_LIGHTS_LAMP_LAMP_FIND_H
#define INLAY_HAL_LIGHTS_LAMP_LAMP_FIND_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/optics/fisheye.h"

/* A ball 0.35 m wide, 1 m away; a window is larger. */
#define LAMP_SPOT_RADIUS_MAX 0.175 /* rad */

/* A picture of one linear value a pixel. */
struct lamp_picture {
	const float *light; /* [height][width] */
	int width, height;
	float white; /* from here on light is clipped; INFINITY: nowhere */
	const struct fisheye *lens;
};

struct lamp_spot {
	double px[2]; /* its middle */
	double dir[3];
	double radius; /* rad: of a disc of the same solid angle, as bright as the brightest of it */
	double flux;   /* radiance above the surroundings, times solid angle; clipped: at least */
	double pixel;  /* rad that a pixel is wide there */
	bool clipped;  /* the light is; then the radius is that of what is */
	bool resolved; /* it covers LAMP_SPOT_RESOLVED pixels; else its radius is at most that */
};

/* A disc of 3 pixels across covers them: half of them do not lie on its rim. */
#define LAMP_SPOT_RESOLVED 7

/* Memory for a picture, which grows to the largest; zeroed at first. */
struct lamp_finder {
	int pixels;
	uint8_t *mark; /* [pixels] */
	int *list;     /* [2 pixels] */
};
void lamp_finder_free(struct lamp_finder *finder); /* idempotent */

/* Finds the spots, those of the most flux first, and those below the horizon, too: reflections.
 * Returns how many, at most `most`; -ENOMEM. */
int lamp_find(struct lamp_finder *finder, const struct lamp_picture *picture,
	      struct lamp_spot *spot, int most);

/* Whether within an angle of a direction there is light that stands out from what is around. */
bool lamp_shines(const struct lamp_picture *picture, const double dir[3], double within);

#endif
