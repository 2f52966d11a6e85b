/* SPDX-License-Identifier: MIT */
/* The kernel `grain`, which each file of kernels compiles for its instructions: no operation of it
 * depends on how many values are computed at once. Included by kernels_*.c alone. */
#ifndef INLAY_HAL_COMPOSITOR_KERNELS_KERNELS_GRAIN_H
#define INLAY_HAL_COMPOSITOR_KERNELS_KERNELS_GRAIN_H

#include <math.h>

#include "hal/compositor/kernels/kernels.h"

static void kernel_add_grain(const struct kernel_grain *g)
{
	const int32_t *restrict object = g->object, *restrict taken = g->taken;
	const int32_t *restrict covered = g->covered;
	const float *restrict background = g->background;
	const int8_t *restrict noise = g->noise;
	const float floor = g->floor, slope = g->slope;
	int32_t *restrict to = g->to;

	for (int x = 0; x < KERNEL_GRAIN; x++) {
		const float left = (float)(65535 - covered[x]) * (1.0f / 65535);
		const float o = (float)object[x] * 0x1p-24f;
		const float b = background[x] * (1.0f / 65535);
		float ratio = 1.0f - (float)taken[x] * 0x1p-24f, k, light, variance;

		ratio = ratio > 0.0f ? ratio : 0.0f;
		k = ratio * left;
		light = o + k * b;
		light = light < 1.0f ? light : 1.0f;
		variance = floor * (1.0f - k * k) + slope * (light - k * k * b);
		variance = variance > 0.0f ? variance : 0.0f;
		to[x] = object[x] +
			(int32_t)(sqrtf(variance) * (float)noise[x] * (0x1p24f / KERNEL_GRAIN_ONE));
	}
}

#endif
