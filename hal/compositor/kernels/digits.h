/* SPDX-License-Identifier: MIT */
/*
 * Integers as balanced digits of base 4096 (kernels.h). Private to hal/compositor.
 */
#ifndef INLAY_HAL_COMPOSITOR_KERNELS_DIGITS_H
#define INLAY_HAL_COMPOSITOR_KERNELS_DIGITS_H

#include <stdint.h>

#include "hal/compositor/kernels/kernels.h"

#define DIGIT_HALF 2048
/* 2048 in every digit. Added to a number it makes all digits non-negative, so that each can be
 * masked out. */
#define DIGITS_BIAS                                                                                \
	(DIGIT_HALF * (1 + (INT64_C(1) << 12) + (INT64_C(1) << 24) + (INT64_C(1) << 36)))

/* Number of digits that hold every number in -most..most; 0 for 0. most <= 2^46. */
static inline int digits_of(int64_t most)
{
	int64_t held = 0;
	int digits = 0;

	while (held < most) {
		held = held * 4096 + DIGIT_HALF - 1;
		digits++;
	}
	return digits;
}

/* Extracts digit d of each number. */
static inline void digits_split(const int64_t *number, int count, int d, int16_t *digit)
{
	const int shift = d * KERNEL_DIGIT_BITS;

	for (int i = 0; i < count; i++)
		digit[i] = (int16_t)((((uint64_t)(number[i] + DIGITS_BIAS) >> shift) & 4095) -
				     DIGIT_HALF);
}

#endif
