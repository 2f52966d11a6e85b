/* SPDX-License-Identifier: MIT */
/*
 * Where a sky needs finer lights: where its light is not spread evenly over the cells of a dome, as
 * that of a sun or of small lamps.
 *
 * A dome spreads the light of each cell evenly. How far that moves light is estimated as
 *
 *     m = 1/2 sum |e - mean e| * spacing / E     rad
 *
 * with the irradiance e of small pieces of a cell, the whole sky's E, and the distance between the
 * dome's nodes. A cell of the base dome is divided where that lessens m by enough, and those cells
 * come first where it does so by the most for each light.
 */
#ifndef INLAY_BAKE_SKY_SKY_PARTS_H
#define INLAY_BAKE_SKY_SKY_PARTS_H

#include <stdbool.h>

#include "hal/optics/dome.h"
#include "hal/optics/panorama.h"

struct sky_parts {
	struct dome_fine *part; /* [count]: one for each cell that is divided, around its light */
	int count;
	int lights;   /* of a dome with these parts */
	bool limited; /* with more lights it would be finer */
};

/* Chooses parts of a dome of a frequency up to DOME_FREQUENCY_MAX / 2, by angles, of at most `most`
 * lights. 0; -E2BIG: the dome alone has more; -EINVAL: frequency; -ENOMEM. */
int sky_parts_choose(struct sky_parts *parts, const struct panorama *panorama, int frequency,
		     int most, struct fault *fault);
void sky_parts_free(struct sky_parts *parts); /* idempotent; zeroed is fine */

#endif
