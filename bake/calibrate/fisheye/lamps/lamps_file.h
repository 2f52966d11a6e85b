/* SPDX-License-Identifier: MIT */
/* Lamps whose directions are known, in a text file. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_LAMPS_LAMPS_FILE_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_LAMPS_LAMPS_FILE_H

#include <stdbool.h>

#include "hal/base/fault.h"

#define LAMPS_MAX 1000

struct lamp {
	double dir[3]; /* unit, in the world */
	bool hinted;   /* near_px: about where it is seen */
	double near_px[2];
	int line; /* of the file, from 1 */
};

struct lamps {
	struct lamp *lamp;
	int count;
};

/*
 * Lines of
 *     azimuth elevation     degrees: from world X towards world Y, and up from the horizon
 *     dx dy dz              any length
 * and after either, where it is known, about where the lamp is seen: xf yf, in pixels. Blank lines
 * and what follows # are passed over. -ENOENT...; -EINVAL: a fault with file, line and what was
 * expected (no number, not finite, too few, no direction, one direction twice, no lamps).
 */
int lamps_read(struct lamps *lamps, const char *path, struct fault *fault);
void lamps_free(struct lamps *lamps); /* idempotent; zeroed is fine */

#endif
