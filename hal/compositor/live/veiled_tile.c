/* SPDX-License-Identifier: MIT */
#include "hal/compositor/live/veiled_tile.h"

#include <string.h>

/* Q16 of 1 - hidden / 255: 65536 for 0, 0 for 255. */
static uint32_t share_left(uint8_t hidden)
{
	return ((255u - hidden) * 65536u + 127u) / 255u;
}

void veiled_tile_read(struct veiled_tile *v, const struct veil *veil, const struct basis_tile *tile,
		      int width)
{
	for (int y = 0; y < tile->height; y++) {
		const size_t from = (size_t)(tile->y + y) * (size_t)width + (size_t)tile->x;
		const size_t to = (size_t)y * BASIS_TILE, count = (size_t)tile->width;

		memcpy(v->front + to, veil->front + from, count);
		memcpy(v->anybody + to, veil->anybody + from, count);
		memcpy(v->foremost + 4 * to, veil->foremost + 4 * from, 4 * count);
	}
}

void veil_values(int32_t (*values)[VEILED_PIXELS], const uint8_t *hidden)
{
	for (int c = 0; c < 3; c++) {
		for (int p = 0; p < VEILED_PIXELS; p++)
			values[c][p] =
				(int32_t)((values[c][p] * (int64_t)share_left(hidden[p]) + 32768) >>
					  16);
	}
}

/* C + coverage (F - C) of a pixel, in code values. */
static void show_foremost(const uint8_t *foremost, uint16_t coverage, uint8_t *pixel)
{
	for (int c = 0; c < 3; c++)
		pixel[c] = (uint8_t)((pixel[c] * (65535u - coverage) + foremost[c] * coverage +
				      32767u) /
				     65535u);
}

void veiled_tile_show(struct veiled_tile *v, struct kernel_row *row)
{
	for (int y = 0; y < row->rows; y++) {
		const size_t at = (size_t)y * BASIS_TILE;

		memcpy(v->background + 4 * at, row->background + y * row->background_step,
		       4 * (size_t)row->count);
		for (size_t x = 0; row->coverage && x < (size_t)row->count; x++) {
			const uint16_t coverage =
				row->coverage[y * row->coverage_step + (ptrdiff_t)x];
			const uint8_t front = v->front[at + x];

			if (front > 0 && front < 255)
				show_foremost(v->foremost + 4 * (at + x), coverage,
					      v->background + 4 * (at + x));
			v->coverage[at + x] = (uint16_t)((coverage * share_left(front) + 32768u) >>
							 16);
		}
	}
	row->background = v->background;
	row->background_step = 4 * (ptrdiff_t)BASIS_TILE;
	if (row->coverage) {
		row->coverage = v->coverage;
		row->coverage_step = BASIS_TILE;
	}
}
