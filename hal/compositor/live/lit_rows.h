/* SPDX-License-Identifier: MIT */
/*
 * Lamps that flicker light each row of a rolling shutter otherwise. The object's light is
 * multiplied by the same,
 *
 *     O' = clamp(floor(O row / 2^16 + 1/2))        clamp() is to +-KERNEL_LIMIT
 *
 * before what is seen through it is added, which has its rows already.
 */
#ifndef INLAY_HAL_COMPOSITOR_LIVE_LIT_ROWS_H
#define INLAY_HAL_COMPOSITOR_LIVE_LIT_ROWS_H

#include <stdint.h>

#include "hal/basis/basis_format.h"

#define LIT_ROWS_ONE 65536 /* rows that change nothing */

/* Multiplies a tile's O by its rows: [height] of R, G, B, 0..4 * LIT_ROWS_ONE. */
void lit_rows_apply(int32_t (*values)[BASIS_TILE * BASIS_TILE], const int32_t (*rows)[3],
		    int height);

#endif
