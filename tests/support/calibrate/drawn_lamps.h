/* SPDX-License-Identifier: MIT */
/* Draws the picture that a fisheye takes of many lamps, with walls, noise and other bright things. */
#ifndef INLAY_TESTS_SUPPORT_CALIBRATE_DRAWN_LAMPS_H
#define INLAY_TESTS_SUPPORT_CALIBRATE_DRAWN_LAMPS_H

#include <stdbool.h>

#include "bake/calibrate/fisheye/lamps/lamps_file.h"
#include "hal/image/image.h"
#include "hal/optics/fisheye.h"
#include "tests/support/chance.h"

enum { DRAWN_LAMPS_WIDTH = 640, DRAWN_LAMPS_HEIGHT = 480, DRAWN_LAMPS_MAX = 100 };

/* Light is linear; 1 is white. */
struct drawn_lamps {
	const struct fisheye_settings *lens;
	double walls;	    /* light of the room */
	double lamp_light;  /* in the middle of a lamp */
	double noise;	    /* standard deviation in 8-bit code values */
	int reflections;    /* bright spots that are no lamps */
	int hidden;	    /* this many of the first lamps are not drawn */
	bool mirrored;	    /* the picture is flipped left to right */
	bool window;	    /* a bright rectangle */
	struct lamps lamps; /* points to `lamp`: the structure must not move */
	struct lamp lamp[DRAWN_LAMPS_MAX];
};

/* Sets lamps: irregularly over the field, up to most_deg from the lens's axis. */
void drawn_lamps_place(struct drawn_lamps *d, int count, double most_deg, struct chance *chance);

/* Creates the picture; the caller frees it. 0 or -ENOMEM. */
int drawn_lamps_draw(const struct drawn_lamps *d, struct image *image, struct chance *chance);

#endif
