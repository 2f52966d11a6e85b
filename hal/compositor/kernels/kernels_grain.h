/* SPDX-License-Identifier: MIT */
/* The kernels `grain` and `divide`, which each file of kernels compiles for its instructions: none
 * of their operations depends on how many values are computed at once. Included by kernels_*.c
 * alone. */
#ifndef INLAY_HAL_COMPOSITOR_KERNELS_KERNELS_GRAIN_H
#define INLAY_HAL_COMPOSITOR_KERNELS_KERNELS_GRAIN_H

#include <math.h>
#include <string.h>

#include "hal/compositor/kernels/kernels.h"

/* One channel of a row. left: 1 - coverage; pixel: BGRX, whose byte 2 - c is the channel's. */
static inline void kernel_grain_channel(const struct kernel_grain *g, int c, int y,
					const float *restrict left, const uint32_t *restrict pixel)
{
	const int32_t *restrict object = g->object[c] + y * KERNEL_GRAIN;
	const int32_t *restrict taken = g->taken[c] + y * KERNEL_GRAIN;
	const int8_t *restrict table = g->noise[c] + y * g->noise_step;
	const float floor = g->floor[c], slope = g->slope[c];
	const float *light = g->curves->light;
	const int shift = 16 - 8 * c;
	int32_t *restrict to = g->to[c] + y * KERNEL_GRAIN;
	float noise[KERNEL_GRAIN];

	for (int x = 0; x < KERNEL_GRAIN; x++)
		noise[x] = (float)table[x] * (0x1p24f / KERNEL_GRAIN_ONE);
/* `to` may be `object`: no pixel reads what another writes. clang finds that out in running. */
#ifndef __clang__
#pragma GCC ivdep
#endif
	for (int x = 0; x < KERNEL_GRAIN; x++) {
		const float code = (float)(int32_t)(pixel[x] >> shift & 255);
		const float b = light[0] + code * (light[1] + code * (light[2] + code * light[3]));
		const float ratio = 1.0f - (float)taken[x] * 0x1p-24f;
		const float k = (ratio > 0.0f ? ratio : 0.0f) * left[x];
		const float all = (float)object[x] * 0x1p-24f + k * b;
		const float seen = all < 1.0f ? all : 1.0f;
		const float variance = floor * (1.0f - k * k) + slope * (seen - k * k * b);

		to[x] = object[x] + (int32_t)(sqrtf(variance > 0.0f ? variance : 0.0f) * noise[x]);
	}
}

static void kernel_add_grain(const struct kernel_grain *g)
{
	for (int y = 0; y < g->rows; y++) {
		const uint16_t *coverage = g->coverage + y * g->coverage_step;
		float left[KERNEL_GRAIN];
		uint32_t pixel[KERNEL_GRAIN];

		memcpy(pixel, g->background + y * g->background_step, sizeof(pixel));
		for (int x = 0; x < KERNEL_GRAIN; x++)
			left[x] = (float)(65535 - coverage[x]) * (1.0f / 65535);
		for (int c = 0; c < 3; c++)
			kernel_grain_channel(g, c, y, left, pixel);
	}
}

static void kernel_divide(int32_t value[256], const float grid[KERNEL_GRID * KERNEL_GRID])
{
	enum { SIDE = 16, STEP = SIDE / (KERNEL_GRID - 1) };
	const float most = KERNEL_LIMIT;
	float wide[KERNEL_GRID][SIDE], quotient[SIDE];

	for (int j = 0; j < KERNEL_GRID; j++)
		for (int x = 0; x < SIDE; x++) {
			const float *left = &grid[j * KERNEL_GRID + x / STEP];

			wide[j][x] = left[0] +
				     ((float)(x % STEP) + 0.5f) / STEP * (left[1] - left[0]);
		}
	for (int y = 0; y < SIDE; y++) {
		const float *restrict upper = wide[y / STEP], *restrict lower = wide[y / STEP + 1];
		const float v = ((float)(y % STEP) + 0.5f) / STEP;
		int32_t *restrict row = value + y * SIDE;

		/* Apart, or gcc 12 makes branches of the clamps. */
		for (int x = 0; x < SIDE; x++) {
			const float light = upper[x] + v * (lower[x] - upper[x]);

			quotient[x] = (float)row[x] / light;
		}
		for (int x = 0; x < SIDE; x++)
			quotient[x] = quotient[x] < most ? quotient[x] : most;
		for (int x = 0; x < SIDE; x++)
			quotient[x] = quotient[x] > -most ? quotient[x] : -most;
		for (int x = 0; x < SIDE; x++)
			row[x] = (int32_t)quotient[x];
	}
}

#endif
