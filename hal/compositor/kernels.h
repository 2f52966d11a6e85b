/*
 * The inner loops of the compositor. Private to hal/compositor.
 *
 * What a kernel computes is an exact integer, so every implementation gives the same bits in
 * whatever order it sums.
 */
#ifndef INLAY_HAL_COMPOSITOR_KERNELS_H
#define INLAY_HAL_COMPOSITOR_KERNELS_H

#include "hal/basis/basis.h"
#include "hal/compositor/weights.h"

/* sum[p][c] = sum over i of row[p][c][i] * weight[c][i], each below 2^62 in magnitude. */
void kernel_sums_c(const struct basis_block *block, const struct segments segments[3],
		   int64_t (*sum)[3]);

#endif
