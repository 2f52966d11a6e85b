/* SPDX-License-Identifier: MIT */
/* Bright spots in a picture, to fractions of a pixel. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_LAMPS_LAMPS_SPOTS_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_LAMPS_LAMPS_SPOTS_H

#include "hal/image/image.h"

struct spot {
	double px[2];	  /* centroid of its linear light */
	double radius_px; /* radius of a circle of the same area */
	double light;	  /* sum of its light above its edge level */
};

struct spots {
	struct spot *spot; /* the largest light first */
	int count;
};

/*
 * Finds spots. A spot is connected, small (6 % of the picture's smaller side across), not cut by
 * the picture's border, half as bright again as what connects it to anything brighter or larger,
 * and at least 4 % as bright as the brightest pixel. The centroid of a clipped spot is right if the
 * spot is symmetric. At most SPOTS_MAX are kept. -ENOMEM.
 */
#define SPOTS_MAX 400
int spots_find(struct spots *spots, const struct image *picture);
void spots_free(struct spots *spots); /* idempotent; zeroed is fine */

#endif
