/* SPDX-License-Identifier: MIT */
/* Where the bright image circle of a fisheye ends in a picture: points of its rim, to parts of a
 * pixel. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_CIRCLE_FISHEYE_RIM_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_CIRCLE_FISHEYE_RIM_H

#include <stdbool.h>

#include "hal/image/image.h"

struct rim_edge {
	double px[2];
	bool clipped;	  /* what lies inside is as bright as the picture can show */
	double deviation; /* px; of edges_place() alone */
};

#define RIM_CLIPPED 0.97 /* of what 8 bits can show: brighter may be brighter still */

struct rim {
	struct rim_edge *edge; /* in order around the middle */
	int count;
	int rays; /* how many directions were looked along */
	int cut;  /* of them, those still bright where the picture ends */
	/* The picture that was looked at. */
	int width, height;
	float *light;	    /* linear, of the three channels together */
	bool codes;	    /* 8-bit: 1 is the most */
	double dark, noise; /* of the surroundings: of edges_place() */
	double blur;	    /* px, standard deviation: of edges_place() */
};

/*
 * Looks inward along rays to a point inside of the circle (NULL: the middle of what is bright). An
 * edge is where the picture first stays brighter than its dark surroundings: half of the way in
 * linear light (8-bit pictures are taken as sRGB). count is 0 where nothing stands out. -ENOMEM.
 */
int rim_find(struct rim *rim, const struct image *picture, const double middle[2]);
void rim_free(struct rim *rim); /* idempotent; zeroed is fine */

#endif
