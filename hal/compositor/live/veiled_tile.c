/* SPDX-License-Identifier: MIT */
#include "hal/compositor/live/veiled_tile.h"

#include <stdbool.h>
#include <string.h>

/* Q16 of 1 - hidden / 255: 65536 for 0, 0 for 255. */
static uint32_t share_left(uint8_t hidden)
{
	const uint32_t left = 255u - hidden;

	return left * 257u + (left >> 7); /* (left * 65536 + 127) / 255 */
}

/* Whether all pixels of a tile's row are hidden alike, so that nothing need be computed. */
static bool is_even(const uint8_t *hidden, uint8_t all)
{
	return hidden[0] == all && !memcmp(hidden, hidden + 1, BASIS_TILE - 1);
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

/* Multiplies a row of a tile. */
static void veil_row(int32_t *values, const uint8_t *hidden)
{
	if (is_even(hidden, 255)) {
		memset(values, 0, BASIS_TILE * sizeof(*values));
		return;
	}
	for (int x = 0; x < BASIS_TILE; x++)
		values[x] = (int32_t)((values[x] * (int64_t)share_left(hidden[x]) + 32768) >> 16);
}

void veil_values(int32_t (*values)[VEILED_PIXELS], const uint8_t *hidden)
{
	for (int at = 0; at < VEILED_PIXELS; at += BASIS_TILE)
		for (int c = 0; c < 3 && !is_even(hidden + at, 0); c++)
			veil_row(values[c] + at, hidden + at);
}

/* C + coverage (F - C) of a pixel, in code values. */
static void show_foremost(const uint8_t *foremost, uint16_t coverage, uint8_t *pixel)
{
	for (int c = 0; c < 3; c++)
		pixel[c] = (uint8_t)((pixel[c] * (65535u - coverage) + foremost[c] * coverage +
				      32767u) /
				     65535u);
}

/* Takes what hides a row's object from its coverage, and shows the people's own colour there. */
static void show_row(struct veiled_tile *v, const uint16_t *coverage, size_t at, int count)
{
	const uint8_t *front = v->front + at;

	if (is_even(front, 0) || is_even(front, 255)) {
		for (int x = 0; x < count; x++)
			v->coverage[at + (size_t)x] = front[0] ? 0 : coverage[x];
		return;
	}
	for (int x = 0; x < count; x++) {
		const size_t to = at + (size_t)x;

		if (front[x] > 0 && front[x] < 255)
			show_foremost(v->foremost + 4 * to, coverage[x], v->background + 4 * to);
		v->coverage[to] = (uint16_t)((coverage[x] * share_left(front[x]) + 32768u) >> 16);
	}
}

void veiled_tile_show(struct veiled_tile *v, struct kernel_row *row)
{
	for (int y = 0; y < row->rows; y++) {
		const size_t at = (size_t)y * BASIS_TILE;

		memcpy(v->background + 4 * at, row->background + y * row->background_step,
		       4 * (size_t)row->count);
		if (row->coverage)
			show_row(v, row->coverage + y * row->coverage_step, at, row->count);
	}
	row->background = v->background;
	row->background_step = 4 * (ptrdiff_t)BASIS_TILE;
	if (row->coverage) {
		row->coverage = v->coverage;
		row->coverage_step = BASIS_TILE;
	}
}
