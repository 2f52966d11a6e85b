/* SPDX-License-Identifier: MIT */
/* Bright spots in a picture, to parts of a pixel. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_LAMPS_LAMPS_SPOTS_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_LAMPS_LAMPS_SPOTS_H

#include "hal/image/image.h"

struct spot {
	double px[2];	  /* centroid of its linear light */
	double radius_px; /* of a circle as large as it */
	double light;	  /* all of it, above its surroundings */
};

struct spots {
	struct spot *spot; /* the one of most light first */
	int count;
};

/*
 * A spot is what is connected, small (6 % of the picture's smaller side across), not cut by the
 * picture's edge, half as bright again as what joins it to anything brighter or larger, and no
 * dimmer than 4 % of the brightest pixel. Clipped ones are as good as they are symmetric. At most
 * SPOTS_MAX are kept. -ENOMEM.
 */
#define SPOTS_MAX 400
int spots_find(struct spots *spots, const struct image *picture);
void spots_free(struct spots *spots); /* idempotent; zeroed is fine */

#endif
