/* Which pixels make up which light, with what weight. */
#ifndef INLAY_HAL_LIGHTS_SAMPLER_TABLE_H
#define INLAY_HAL_LIGHTS_SAMPLER_TABLE_H

#include "hal/lights/sampler.h"

/* The weights of a light sum to exactly this, so that a constant picture gives that constant. */
#define SAMPLER_WEIGHT_BITS 31

/* count pixels to the right from (x, y). */
struct sampler_span {
	uint16_t x, y, count;
};

/* Light by light: its sums stay in registers, and spans and weights are read once, in order. */
struct sampler_table {
	int lights;
	int *first; /* [lights + 1]: spans of light i are first[i]..first[i + 1] - 1 */
	struct sampler_span *span; /* row by row within a light */
	uint32_t *weight;	   /* one for each pixel of each span, in order */
	int unseen;		   /* lights without spans */
};

/* -ENOMEM. Zeroed on failure. */
int sampler_table_create(struct sampler_table *table, const struct dome *dome,
			 const struct fisheye *lens, int width, int height,
			 enum light_estimator estimator);
void sampler_table_free(struct sampler_table *table); /* idempotent; zeroed is fine */

#endif
