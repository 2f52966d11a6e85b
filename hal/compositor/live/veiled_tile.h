/* SPDX-License-Identifier: MIT */
/*
 * Takes from a tile what people hide (veil.h), before it is mixed. The mixing kernel has no case
 * for it.
 */
#ifndef INLAY_HAL_COMPOSITOR_LIVE_VEILED_TILE_H
#define INLAY_HAL_COMPOSITOR_LIVE_VEILED_TILE_H

#include "hal/basis/basis.h"
#include "hal/compositor/kernels/kernels.h"
#include "hal/compositor/live/veil.h"

#define VEILED_PIXELS (BASIS_TILE * BASIS_TILE)

/* A tile's part of the veil, and scratch memory for its pixels. All arrays have rows of
 * BASIS_TILE. */
struct veiled_tile {
	uint8_t front[VEILED_PIXELS], anybody[VEILED_PIXELS];
	uint8_t foremost[VEILED_PIXELS * 4];
	uint16_t coverage[VEILED_PIXELS];
	uint8_t background[VEILED_PIXELS * 4];
};

/* Reads a tile's part of the veil; width: of the picture. */
void veiled_tile_read(struct veiled_tile *veiled, const struct veil *veil,
		      const struct basis_tile *tile, int width);

/* Multiplies values by 1 - hidden / 255. */
void veil_values(int32_t (*values)[VEILED_PIXELS], const uint8_t *hidden);

/* Replaces the row's coverage and background by those that people leave. */
void veiled_tile_show(struct veiled_tile *veiled, struct kernel_row *row);

#endif
