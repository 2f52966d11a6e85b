/* SPDX-License-Identifier: MIT */
/* Pictures of lamps as a known fisheye sees them, for the tests of what finds them. */
#ifndef INLAY_TESTS_SUPPORT_CALIBRATE_DRAWN_LAMPS_H
#define INLAY_TESTS_SUPPORT_CALIBRATE_DRAWN_LAMPS_H

#include "hal/image/image.h"
#include "hal/optics/fisheye.h"

struct drawn_lamp {
	double at[3], radius; /* metres */
	double radiance;
};

/* A room: lamps under an even sky. */
struct drawn_room {
	const struct drawn_lamp *lamp;
	int lamps;
	double sky;
};

/* Draws linear light, as seen from a place, with 4 x 4 points a pixel. turn: rad about each axis,
 * by which the fisheye is turned otherwise than its lens says. The caller frees the picture. */
void draw_lamps(struct image *picture, const struct drawn_room *room, const struct fisheye *lens,
		int side, const double at[3], const double turn[3]);

/* Makes sRGB code values of it, in place. */
void encode_lamps(struct image *picture, double exposure);

#endif
