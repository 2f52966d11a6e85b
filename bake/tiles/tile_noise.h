/* SPDX-License-Identifier: MIT */
/* How noisy a tile is, from what its batches of samples differ by under a uniform sky. */
#ifndef INLAY_BAKE_TILES_TILE_NOISE_H
#define INLAY_BAKE_TILES_TILE_NOISE_H

#include "bake/tiles/tile.h"

/* After a batch of that many samples a pixel: one more value of pixel at. */
void tile_noise_add(struct tile *tile, int at, int samples);

/* Sets the tile's noise_square and noise_count. Returns the standard error of the mean over
 * batches in 8-bit levels, RMS over the tile's changed pixels; 0: not known. */
double tile_noise_judge(struct tile *tile);

#endif
