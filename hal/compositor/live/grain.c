/* SPDX-License-Identifier: MIT */
#include "hal/compositor/live/grain.h"

#include <stdbool.h>
#include <string.h>

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
	return most < KERNEL_FAINT;
}

_Static_assert((int)BASIS_TILE == (int)KERNEL_GRAIN, "kernels take the rows of a tile");

/* Copies coverage and background of a tile that the picture's edge cuts, as kernels read whole
 * rows. */
static void complete_rows(const struct kernel_row *row, struct kernel_grain *tile,
			  struct grain_tile *scratch)
{
	memset(scratch->background, 0, sizeof(scratch->background));
	memset(scratch->coverage, 0, sizeof(scratch->coverage));
	for (int y = 0; y < row->rows; y++) {
		memcpy(scratch->background + (size_t)(y * BASIS_TILE) * 4,
		       tile->background + y * tile->background_step, (size_t)row->count * 4);
		memcpy(scratch->coverage + y * BASIS_TILE, tile->coverage + y * tile->coverage_step,
		       (size_t)row->count * sizeof(*tile->coverage));
	}
	tile->background = scratch->background;
	tile->background_step = (ptrdiff_t)BASIS_TILE * 4;
	tile->coverage = scratch->coverage;
	tile->coverage_step = BASIS_TILE;
}

void grain_add(const struct grain *g, const struct kernels *kernels, int tile,
	       struct kernel_row *row, struct grain_tile *scratch)
{
	static const uint16_t uncovered[BASIS_TILE];
	const uint64_t place = mixed(g->seed ^ mixed((uint64_t)tile));
	const int left = (int)(place % (GRAIN_SIDE - BASIS_TILE + 1));
	const int top = (int)(place / GRAIN_SIDE % (GRAIN_SIDE - BASIS_TILE + 1));
	struct kernel_grain grain;

	if (is_faint(row))
		return;
	if (!row->coverage) {
		row->coverage = uncovered;
		row->coverage_step = 0;
	}
	grain = (struct kernel_grain){.rows = row->rows,
				      .coverage = row->coverage,
				      .background = row->background,
				      .curves = row->curves,
				      .coverage_step = row->coverage_step,
				      .noise_step = GRAIN_SIDE,
				      .background_step = row->background_step};
	if (row->count < BASIS_TILE)
		complete_rows(row, &grain, scratch);
	for (int c = 0; c < 3; c++) {
		grain.object[c] = row->object[c];
		grain.taken[c] = row->taken[c];
		grain.noise[c] = g->table[c] + top * GRAIN_SIDE + left;
		grain.floor[c] = g->floor[c];
		grain.slope[c] = g->slope[c];
		grain.to[c] = scratch->object[c];
	}
	kernels->grain(&grain);
	for (int c = 0; c < 3; c++)
		row->object[c] = scratch->object[c];
}
