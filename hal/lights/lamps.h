/* SPDX-License-Identifier: MIT */
/*
 * Lamps that hang so near that their light depends on the place, and where the fisheye stands that
 * measures them. Everything else of the sky is light from afar.
 */
#ifndef INLAY_HAL_LIGHTS_LAMPS_H
#define INLAY_HAL_LIGHTS_LAMPS_H

enum { LAMPS_MAX = 8 };

struct lamp {
	double position[3]; /* metres, world */
	double radius;	    /* metres; > 0 */
};

struct lamps {
	int count;
	struct lamp lamp[LAMPS_MAX];
	double fisheye[3]; /* the lens's place in the world, metres */
};

#endif
