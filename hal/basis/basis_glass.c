/* SPDX-License-Identifier: MIT */
#include "hal/basis/basis_glass.h"

/* Sort key of a pixel: tile, row, column. */
static uint64_t glass_rank(const struct basis *basis, const struct basis_glass *g)
{
	const uint64_t tile = (uint64_t)basis_glass_tile(basis, g);

	return (tile * BASIS_TILE + g->y % BASIS_TILE) * BASIS_TILE + g->x % BASIS_TILE;
}

int basis_read_glass(const struct basis_reader *r, const struct basis_chunk_entry *chunk,
		     struct basis_pose *pose)
{
	const struct basis_info_chunk *info = &r->basis->info;
	const struct basis_glass *glass;

	if (!chunk)
		return 0;
	if (chunk->bytes % sizeof(*glass))
		return basis_damaged(r, "GLAS chunk of %llu bytes, expected a multiple of %zu",
				     (unsigned long long)chunk->bytes, sizeof(*glass));
	glass = (const void *)(r->data + chunk->offset);
	pose->glass_count = chunk->bytes / sizeof(*glass);
	for (size_t i = 0; i < pose->glass_count; i++) {
		const struct basis_glass *g = &glass[i];

		if (g->x >= info->width || g->y >= info->height)
			return basis_damaged(
				r,
				"pixel %zu that is seen through is %u, %u, expected one of %ux%u",
				i, g->x, g->y, info->width, info->height);
		if (i && glass_rank(r->basis, g) <= glass_rank(r->basis, g - 1))
			return basis_damaged(
				r,
				"pixel %zu that is seen through, %u, %u, follows %u, %u, expected the order of tiles, rows and columns",
				i, g->x, g->y, g[-1].x, g[-1].y);
	}
	pose->glass = glass;
	return 0;
}
