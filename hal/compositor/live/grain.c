/* SPDX-License-Identifier: MIT */
#include "hal/compositor/live/grain.h"

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

static void grain_row(const struct grain *g, const struct kernels *kernels,
		      const struct kernel_row *row, int y, size_t place, struct grain_tile *scratch)
{
	const uint8_t *pixels = row->background + y * row->background_step;
	int32_t covered[BASIS_TILE] = {0};
	float background[3][BASIS_TILE] = {{0}};

	for (int x = 0; x < row->count; x++) {
		if (row->coverage)
			covered[x] = row->coverage[y * row->coverage_step + x];
		for (int c = 0; c < 3; c++)
			background[c][x] = row->curves->linear[pixels[4 * x + 2 - c]];
	}
	for (int c = 0; c < 3; c++)
		kernels->grain(&(struct kernel_grain){
			.object = row->object[c] + y * row->value_step,
			.taken = row->taken[c] + y * row->value_step,
			.covered = covered,
			.background = background[c],
			.noise = g->table[c] + place + (size_t)y * GRAIN_SIDE,
			.floor = g->floor[c],
			.slope = g->slope[c],
			.to = scratch->object[c] + y * BASIS_TILE});
}

_Static_assert((int)BASIS_TILE == (int)KERNEL_GRAIN, "kernels take a row of a tile");

void grain_add(const struct grain *g, const struct kernels *kernels, int tile,
	       struct kernel_row *row, struct grain_tile *scratch)
{
	static const uint16_t uncovered[BASIS_TILE];
	const uint64_t place = mixed(g->seed ^ mixed((uint64_t)tile));
	const int left = (int)(place % (GRAIN_SIDE - BASIS_TILE + 1));
	const int top = (int)(place / GRAIN_SIDE % (GRAIN_SIDE - BASIS_TILE + 1));

	if (is_faint(row))
		return;
	for (int y = 0; y < row->rows; y++)
		grain_row(g, kernels, row, y, (size_t)(top * GRAIN_SIDE + left), scratch);
	for (int c = 0; c < 3; c++)
		row->object[c] = scratch->object[c];
	if (!row->coverage) {
		row->coverage = uncovered;
		row->coverage_step = 0;
	}
}
