/* SPDX-License-Identifier: MIT */
/*
 * Computes O and 1 - ratio for the pixels of one tile. Private to hal/compositor.
 */
#ifndef INLAY_HAL_COMPOSITOR_TILE_H
#define INLAY_HAL_COMPOSITOR_TILE_H

#include "hal/compositor/block_sums.h"

/* The light of one frame, read by all workers. */
struct frame_light {
	const struct kernels *kernels;
	const struct light_vector *object;
	const struct light_vector *taken, *own; /* of D; of U */
	const struct light_vector *ground;	/* [grounds] */
	int gain_bits;
	const struct block_plan *end; /* of the layer's blocks */
};

/* O and 1 - ratio in Q24 (kernels.h), [c][y * BASIS_TILE + x]. If tile_plan.object or .taken is
 * false, that array is not written. */
struct tile_values {
	int32_t object[3][BLOCK_PIXELS] __attribute__((aligned(64)));
	int32_t taken[3][BLOCK_PIXELS] __attribute__((aligned(64)));
};

extern const int32_t tile_nothing[BLOCK_PIXELS]; /* zeros */

/* Scratch memory of one worker. */
struct tile_work {
	struct block_work block;
	const struct block_plan *end, *after; /* of the tile's blocks; what is computed next */
	int64_t d[3][BLOCK_PIXELS], u[3][BLOCK_PIXELS];
	/* values of the pixels that a block lists, channel by channel */
	int32_t listed[3 * BLOCK_PIXELS + KERNEL_PLACE_BEYOND] __attribute__((aligned(64)));
};

/* after: the first block of the tile that is computed next, of which some is prefetched. */
void tile_compute(const struct frame_light *light, const struct tile_plan *tile,
		  const struct block_plan *after, struct tile_work *work,
		  struct tile_values *values);

#endif
