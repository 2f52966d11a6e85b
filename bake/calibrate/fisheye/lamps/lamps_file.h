/* SPDX-License-Identifier: MIT */
/* Text files of lamps in known directions. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_LAMPS_LAMPS_FILE_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_LAMPS_LAMPS_FILE_H

#include <stdbool.h>

#include "hal/base/fault.h"

#define LAMPS_MAX 1000

struct lamp {
	double dir[3]; /* unit vector, in the world */
	bool hinted;   /* near_px is given: approximate place in the picture */
	double near_px[2];
	int line; /* line of the file, from 1 */
};

struct lamps {
	struct lamp *lamp;
	int count;
};

/*
 * Reads lines of
 *     azimuth elevation     degrees: from world X towards world Y, and up from the horizon
 *     dx dy dz              of any length
 * each optionally followed by the lamp's approximate place in the picture: xf yf, in pixels. Blank
 * lines and what follows # are ignored. -ENOENT...; -EINVAL: the fault says file, line and what was
 * expected (not a number, not finite, too few, a zero direction, one direction twice, no lamps).
 */
int lamps_read(struct lamps *lamps, const char *path, struct fault *fault);
void lamps_free(struct lamps *lamps); /* idempotent; zeroed is fine */

#endif
