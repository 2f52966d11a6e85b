/* SPDX-License-Identifier: MIT */
/* The geometry behind the sampler's table: which pixels show which lights, and with what weight. */
#ifndef INLAY_HAL_LIGHTS_SAMPLER_SHARES_H
#define INLAY_HAL_LIGHTS_SAMPLER_SHARES_H

#include <stddef.h>

#include "hal/lights/sampler.h"
#include "hal/optics/dome_placed.h"

/* Weight of a pixel in the mean of a light. */
struct sampler_share {
	int light;
	uint16_t x, y;
	float weight; /* any unit, the same for all pixels of a light */
};

/* The shares of one light are in order: from top to bottom, and from left to right in a row. */
struct sampler_shares {
	struct sampler_share *items;
	size_t count, room;
};

/* placed not NULL: the shares of cell i are divided into those of its thirds DOME_PLACED_THIRDS * i + k, so
 * that light can be placed inside cells; *placed stays NULL, and shares whole, where lights are not cells or
 * cells are too wide. 0 or -ENOMEM; empty on failure. */
int sampler_shares_create(struct sampler_shares *shares, const struct dome *dome,
			  const struct fisheye *lens, int width, int height,
			  enum light_estimator estimator, struct dome_placed **placed);
void sampler_shares_free(struct sampler_shares *shares); /* idempotent; zeroed is fine */

#endif
