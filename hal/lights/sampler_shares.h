/* SPDX-License-Identifier: MIT */
/* The geometry behind the sampler's table: which pixels show which lights, and with what weight. */
#ifndef INLAY_HAL_LIGHTS_SAMPLER_SHARES_H
#define INLAY_HAL_LIGHTS_SAMPLER_SHARES_H

#include <stddef.h>

#include "hal/lights/sampler.h"
#include "hal/optics/dome_placed.h"

/* Pixels side by side in a row that have weights in the mean of a light. */
struct sampler_run {
	int light;
	uint16_t x, y, count;
	size_t first; /* index of its first pixel's weight */
};

/* The runs of one light are in order: from top to bottom, and from left to right in a row. */
struct sampler_shares {
	struct sampler_run *run;
	/* any unit, the same for all pixels of a light; divided by the lens's falloff */
	float *weight;
	double *undimmed; /* [lights]: sums of the weights before that division */
	size_t runs, run_room, weights, weight_room;
};

/* placed not NULL: the shares of cell i are divided into those of its thirds DOME_PLACED_THIRDS * i
 * + k, so that light can be placed inside cells; *placed stays NULL, and shares whole, where
 * cells are too wide. 0 or -ENOMEM; empty on failure. */
int sampler_shares_create(struct sampler_shares *shares, const struct dome *dome,
			  const struct fisheye *lens, int width, int height,
			  struct dome_placed **placed);
void sampler_shares_free(struct sampler_shares *shares); /* idempotent; zeroed is fine */

#endif
