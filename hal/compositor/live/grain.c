/* SPDX-License-Identifier: MIT */
#include "hal/compositor/live/grain.h"

#include <math.h>
#include <stdbool.h>

/* A shadow that takes less light than this, in Q24, keeps the background's own noise. */
#define FAINT (INT32_C(1) << 19)

/* splitmix64 */
static uint64_t mixed(uint64_t x)
{
	x += 0x9e3779b97f4a7c15u;
	x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
	x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
	return x ^ (x >> 31);
}

/* Whether the object changes nothing in the tile but a faint shadow. */
static bool is_faint(const struct kernel_row *row)
{
	int32_t most = 0;

	if (row->coverage)
		return false;
	for (int y = 0; y < row->rows; y++) {
		const int32_t *taken = row->taken[1] + y * row->value_step;

		for (int x = 0; x < row->count; x++)
			most = taken[x] > most ? taken[x] : most;
	}
	return most < FAINT;
}

/* One row and channel of a tile; left: 1 - coverage. */
static void grain_row(const int32_t *object, const int32_t *taken, const float *left,
		      const float *background, const int8_t *n, float floor, float slope, int count,
		      int32_t *to)
{
	for (int x = 0; x < count; x++) {
		const float o = (float)object[x] * 0x1p-24f, b = background[x];
		float ratio = 1.0f - (float)taken[x] * 0x1p-24f, k, light, variance;

		ratio = ratio > 0.0f ? ratio : 0.0f;
		k = ratio * left[x];
		light = o + k * b;
		light = light < 1.0f ? light : 1.0f;
		variance = floor * (1.0f - k * k) + slope * (light - k * k * b);
		variance = variance > 0.0f ? variance : 0.0f;
		to[x] = object[x] +
			(int32_t)(sqrtf(variance) * (float)n[x] * (0x1p24f / GRAIN_ONE));
	}
}

static void grain_channel(const struct grain *g, int c, const struct kernel_row *row, int y,
			  const int8_t *n, int32_t *to)
{
	const uint8_t *pixels = row->background + y * row->background_step;
	float left[BASIS_TILE], background[BASIS_TILE];

	for (int x = 0; x < row->count; x++) {
		const int covered = row->coverage ? row->coverage[y * row->coverage_step + x] : 0;

		left[x] = (float)(65535 - covered) * (1.0f / 65535);
		background[x] = row->curves->linear[pixels[4 * x + 2 - c]] * (1.0f / 65535);
	}
	grain_row(row->object[c] + y * row->value_step, row->taken[c] + y * row->value_step, left,
		  background, n, g->floor[c], g->slope[c], row->count, to);
}

void grain_add(const struct grain *g, int tile, struct kernel_row *row, struct grain_tile *scratch)
{
	static const uint16_t uncovered[BASIS_TILE];
	const uint64_t place = mixed(g->seed ^ mixed((uint64_t)tile));
	const int left = (int)(place % (GRAIN_SIDE - BASIS_TILE + 1));
	const int top = (int)(place / GRAIN_SIDE % (GRAIN_SIDE - BASIS_TILE + 1));

	if (is_faint(row))
		return;
	for (int c = 0; c < 3; c++) {
		for (int y = 0; y < row->rows; y++)
			grain_channel(g, c, row, y, g->table[c] + (top + y) * GRAIN_SIDE + left,
				      scratch->object[c] + y * BASIS_TILE);
	}
	for (int c = 0; c < 3; c++)
		row->object[c] = scratch->object[c];
	if (!row->coverage) {
		row->coverage = uncovered;
		row->coverage_step = 0;
	}
}
