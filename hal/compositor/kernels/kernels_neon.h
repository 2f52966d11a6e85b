/* SPDX-License-Identifier: MIT */
/*
 * NEON kernels that the table with dot products borrows. Every 64-bit Arm processor runs them.
 * Private to kernels_neon*.c.
 */
#ifndef INLAY_HAL_COMPOSITOR_KERNELS_KERNELS_NEON_H
#define INLAY_HAL_COMPOSITOR_KERNELS_KERNELS_NEON_H

#include <arm_neon.h>

#include "hal/compositor/kernels/kernels_isa.h"

void kernel_neon_sums16(const int16_t *lines, const struct kernel_weights *w,
			int64_t *const sum[3]);
void kernel_neon_values16(const int16_t *lines, const struct kernel_weights *w,
			  int32_t *const value[3]);
void kernel_neon_values8(const int8_t *lines, const struct kernel_weights *w,
			 int32_t *const value[3]);
void kernel_neon_tint(int32_t *value, const uint16_t *by, int count);
void kernel_neon_project(const int16_t *rows, int count, int stride,
			 const struct kernel_vector vector[3], int64_t (*y)[3]);
void kernel_neon_fold(const int64_t *sum, int count, int shift, uint32_t factor,
		      const uint16_t *tint, const int32_t *from, int32_t *to);
void kernel_neon_mix(const struct kernel_row *rows);

#endif
