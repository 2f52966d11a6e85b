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

#include "hal/compositor/near/near_sky.h"

/* Points across a tile, the last on the next tile's edge, at which the ground's light is known. */
enum { NEAR_GRID = 5 };

struct near_tile {
	/* [lamps][NEAR_GRID * NEAR_GRID]: near_sky_even(), row by row; NULL: no ground in it */
	float (*even)[NEAR_GRID * NEAR_GRID][3];
};

struct near_layer {
	struct basis_layer layer;
	struct near_tile *tile;
	struct near_memory *memory; /* of everything above */
};

/* The pose is in memory. -ENOMEM; -EBADMSG: its places are damaged. */
int near_layer_create(struct near_layer *near, const struct near_sky *sky, int pose,
		      const struct basis_layer *layer);
void near_layer_free(struct near_layer *near); /* zeroed is fine */

/*
 * The blocks of V gave taken = sum v X / W in Q24, with W = U + e where near_sky.ground holds.
 * Divides by the light at the pixel over W,
 *
 *     taken /= 1 + sum_l share[l] (even_l - 1)        share[l] = X_l / W
 *
 * in single precision; the reciprocal is bilinear between the points of the grid.
 */
void near_divide(const struct near_tile *tile, int lamps, const float (*share)[3],
		 int32_t (*taken)[BASIS_TILE * BASIS_TILE]);

#endif
