/* SPDX-License-Identifier: MIT */
/*
 * Tells which tiles a shadow cannot change in the light of a frame. A shadow falls on every tile of
 * the ground under some light, and on few of them under those that shine. Private to
 * hal/compositor.
 *
 * A tile is steady where in each channel, in Q24,
 *
 *     sum over patterns of |y_j| scale_j max |coefficient_j|
 *         + sum over chosen columns of |X_i| reach_i + roundings <= steady[v]
 *
 * with v its brightest code (kernel_curves.steady). The left side is at least |1 - ratio| of every
 * pixel, so that mix() would make recode of each code. Clamps bring values nearer to 0, and so does
 * a veil; grain begins at KERNEL_FAINT. What lamps at places make of values is not bounded.
 */
#ifndef INLAY_HAL_COMPOSITOR_STEADY_H
#define INLAY_HAL_COMPOSITOR_STEADY_H

#include "hal/compositor/backdrop.h"
#include "hal/compositor/tile.h"

/* Prefetches what steady_tile() reads of a tile. */
void steady_fetch(const struct tile_plan *tile);

/*
 * Returns true only if mix() of what tile_compute() makes of the tile is kernel_curves.recode of
 * its background, `rows` of this size. May return false although it is. The tile is bounded.
 */
bool steady_tile(const struct frame_light *light, const struct tile_plan *tile,
		 const struct kernel_curves *curves, struct backdrop_rows rows, int width,
		 int height, struct block_work *work);

#endif
