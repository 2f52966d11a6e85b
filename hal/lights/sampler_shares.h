/* SPDX-License-Identifier: MIT */
/* Which pixels show which lights, and how much of them: the geometry behind the sampler's table. */
#ifndef INLAY_HAL_LIGHTS_SAMPLER_SHARES_H
#define INLAY_HAL_LIGHTS_SAMPLER_SHARES_H

#include <stddef.h>

#include "hal/lights/sampler.h"

/* A pixel's part in a light. */
struct sampler_share {
	int light;
	uint16_t x, y;
	float weight; /* in any unit, the same for all of a light */
};

/* Those of one light go from top to bottom, and from left to right in a row. */
struct sampler_shares {
	struct sampler_share *items;
	size_t count, room;
};

/* -ENOMEM. Empty on failure. */
int sampler_shares_create(struct sampler_shares *shares, const struct dome *dome,
			  const struct fisheye *lens, int width, int height,
			  enum light_estimator estimator);
void sampler_shares_free(struct sampler_shares *shares); /* idempotent; zeroed is fine */

#endif
