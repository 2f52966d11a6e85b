/* SPDX-License-Identifier: MIT */
/*
 * A layer of a pose with the lamps of a near_sky: the file's blocks, and after those of each kind
 * in a tile a block of theirs that has a column for each lamp. Lamp l counts as light N + K + l.
 *
 *     T, D, U   column = sum_i t_i w_i L_i for P_l = 1, with the places of the pixels
 *     V         the same of v_i u_i L_i, over near_sky.ground
 *
 * On the ground U depends on the place, too: see near_divide().
 */
#ifndef INLAY_HAL_COMPOSITOR_NEAR_NEAR_LAYER_H
#define INLAY_HAL_COMPOSITOR_NEAR_NEAR_LAYER_H

#include "hal/base/pool.h"
#include "hal/compositor/kernels/kernels.h"
#include "hal/compositor/near/near_sky.h"

/* Points across a tile, the last on the next tile's edge, at which the ground's light is known. */
enum { NEAR_GRID = KERNEL_GRID };

struct near_layer {
	struct basis_layer layer;
	/* Light on the ground, as a multiple of near_sky.ground, at the points of each tile:
	 * [tiles][channels][lamps][NEAR_GRID^2], row by row. One channel where the ground is grey,
	 * or of one colour. */
	float *even;
	int channels;
	bool *ground; /* [tiles]: the tile shows ground, of which `even` is known */
	_Atomic(struct near_memory *) memory; /* of everything above */
};

/* The pose is in memory; pool, which may be NULL, shares out its tiles. -ENOMEM; -EBADMSG: its
 * places are damaged. */
int near_layer_create(struct near_layer *near, const struct near_sky *sky, int pose,
		      const struct basis_layer *layer, struct pool *pool);
void near_layer_free(struct near_layer *near); /* zeroed is fine */

/*
 * The blocks of V gave taken = sum v X / W in Q24, with W = U + e where near_sky.ground holds.
 * Divides by the light at each pixel of the tile over W, by the kernel `divide`:
 *
 *     taken /= 1 + sum_l share[l] (even_l - 1)        share[l] = X_l / W
 */
void near_divide(const struct near_layer *near, int tile, int lamps, const float (*share)[3],
		 const struct kernels *kernels, int32_t (*taken)[BASIS_TILE * BASIS_TILE]);

#endif
