/* SPDX-License-Identifier: MIT */
/* Finds where the bright image circle of a fisheye ends in a picture: points of its rim, to
 * fractions of a pixel. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_CIRCLE_FISHEYE_RIM_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_CIRCLE_FISHEYE_RIM_H

#include <stdbool.h>

#include "hal/image/image.h"

struct rim_edge {
	double px[2];
	bool clipped;	  /* the light inside is clipped */
	double deviation; /* px; set by edges_place() only */
};

#define RIM_CLIPPED 0.97 /* of the largest 8-bit value: above, the true light may be brighter */

struct rim {
	struct rim_edge *edge; /* in order around the middle */
	int count;
	int rays; /* number of directions searched */
	int cut;  /* directions that are still bright where the picture ends */
	/* The picture searched. */
	int width, height;
	float *light;	    /* [height][width], see plain_light() */
	bool codes;	    /* 8-bit: the largest light is 1 */
	double dark, noise; /* of the surroundings; set by edges_place() */
	double blur;	    /* px, standard deviation; set by edges_place() */
};

/*
 * Searches inwards along rays to a point inside of the circle (NULL: the middle of the bright
 * part). An edge is where the picture first stays brighter than its dark surroundings, at half of
 * the step in linear light (8-bit pictures are decoded as sRGB). count is 0 where nothing stands
 * out. -ENOMEM.
 */
int rim_find(struct rim *rim, const struct image *picture, const double middle[2]);
void rim_free(struct rim *rim); /* idempotent; zeroed is fine */

#endif
