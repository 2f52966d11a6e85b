/* SPDX-License-Identifier: MIT */
/* Estimates the noise of a tile from the differences between its batches under a uniform sky. */
#ifndef INLAY_BAKE_TILES_TILE_NOISE_H
#define INLAY_BAKE_TILES_TILE_NOISE_H

#include "bake/tiles/tile.h"

/* Takes in the last batch of pixel `at`, of that many samples. */
void tile_noise_add(struct tile *tile, int at, int samples);

/* Sets the tile's noise_square and noise_count. Returns the standard error of the mean over
 * batches, RMS over the tile's changed pixels, in 8-bit levels; 0: not known. */
double tile_noise_judge(struct tile *tile);

#endif
