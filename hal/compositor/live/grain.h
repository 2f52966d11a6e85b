/* SPDX-License-Identifier: MIT */
/*
 * The camera's noise, added to the object. A camera's noise has, in linear light L (white is 1),
 * the variance
 *
 *     sigma^2(L) = floor + slope L          (read noise and shot noise)
 *
 * The composite shows O + k B with k = (1 - coverage) ratio, whose noise is that of B times k. So
 *
 *     O += n sqrt(sigma^2(O + k B) - k^2 sigma^2(B))
 *
 * with n of variance 1: the object gets all of its noise, its edge the rest, and a shadow what the
 * darker ground is short of. n comes from tables (after the film grain of AV1), at places that
 * depend on the frame's seed and the tile alone: the same frame gets the same bytes.
 */
#ifndef INLAY_HAL_COMPOSITOR_LIVE_GRAIN_H
#define INLAY_HAL_COMPOSITOR_LIVE_GRAIN_H

#include <stdint.h>

#include "hal/basis/basis_format.h"
#include "hal/compositor/kernels/kernels.h"

#define GRAIN_SIDE 256		   /* of a table */
#define GRAIN_ONE KERNEL_GRAIN_ONE /* value of a table that stands for n = 1 */

struct grain {
	float floor[3], slope[3]; /* R, G, B; >= 0 */
	const int8_t *table[3];	  /* [GRAIN_SIDE][GRAIN_SIDE] */
	uint64_t seed;		  /* of the frame */
};

/* Scratch memory of one worker; what row points to after grain_add(). */
struct grain_tile {
	int32_t object[3][BASIS_TILE * BASIS_TILE] __attribute__((aligned(64)));
	uint16_t coverage[BASIS_TILE * BASIS_TILE];
	uint8_t background[BASIS_TILE * BASIS_TILE * 4];
};

/* Adds noise to the object of a tile's row, which then points to scratch where there is noise to
 * add. tile: its number in the picture. */
void grain_add(const struct grain *grain, const struct kernels *kernels, int tile,
	       struct kernel_row *row, struct grain_tile *scratch);

#endif
