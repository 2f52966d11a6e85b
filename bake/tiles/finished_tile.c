/* SPDX-License-Identifier: MIT */
#include "bake/tiles/finished_tile.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

size_t finished_tile_bytes(const struct basis_block_payload *blocks, int count)
{
	size_t bytes = 0;

	for (int k = 0; k < count; k++)
		bytes += blocks[k].entry.bytes;
	return bytes;
}

static uint8_t *copy_blocks(struct basis_block_payload *to, const struct basis_block_payload *from,
			    int count, uint8_t *data)
{
	for (int k = 0; k < count; k++) {
		to[k] = from[k];
		to[k].payload = memcpy(data, from[k].payload, from[k].entry.bytes);
		data += from[k].entry.bytes;
	}
	return data;
}

int finished_tile_keep(struct finished_tile *tile, const struct basis_block_payload *shown,
		       int shown_count, const struct basis_block_payload *exact, int exact_count)
{
	const size_t entries = (size_t)(shown_count + exact_count) * sizeof(*tile->blocks);
	uint8_t *data = malloc(entries + finished_tile_bytes(shown, shown_count) +
			       finished_tile_bytes(exact, exact_count) + 1);

	if (!data)
		return -ENOMEM;
	tile->blocks = (struct basis_block_payload *)(void *)data;
	tile->shown = shown_count;
	tile->exact = exact_count;
	data = copy_blocks(tile->blocks, shown, shown_count, data + entries);
	copy_blocks(tile->blocks + shown_count, exact, exact_count, data);
	return 0;
}

int finished_tile_keep_glass(struct finished_tile *tile, const struct basis_glass *glass, int count)
{
	if (!count)
		return 0;
	tile->glass = malloc((size_t)count * sizeof(*glass));
	if (!tile->glass)
		return -ENOMEM;
	memcpy(tile->glass, glass, (size_t)count * sizeof(*glass));
	tile->glass_count = count;
	return 0;
}

int finished_tile_keep_mirror(struct finished_tile *tile, const struct basis_mirror *mirror,
			      int count)
{
	if (!count)
		return 0;
	tile->mirror = malloc((size_t)count * sizeof(*mirror));
	if (!tile->mirror)
		return -ENOMEM;
	memcpy(tile->mirror, mirror, (size_t)count * sizeof(*mirror));
	tile->mirror_count = count;
	return 0;
}

void finished_tile_free(struct finished_tile *tile)
{
	free(tile->blocks);
	free(tile->glass);
	free(tile->mirror);
	*tile = (struct finished_tile){.blocks = NULL};
}
