/* SPDX-License-Identifier: MIT */
#include "hal/basis/basis_glass.h"

/* Sort key of a pixel: tile, row, column. */
static uint64_t pixel_rank(const struct basis *basis, int x, int y)
{
	const uint64_t tile = (uint64_t)basis_tile_of(basis, x, y);

	return (tile * BASIS_TILE + (uint64_t)y % BASIS_TILE) * BASIS_TILE +
	       (uint64_t)x % BASIS_TILE;
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
		if (i && pixel_rank(r->basis, g->x, g->y) <= pixel_rank(r->basis, g[-1].x, g[-1].y))
			return basis_damaged(
				r,
				"pixel %zu that is seen through, %u, %u, follows %u, %u, expected the order of tiles, rows and columns",
				i, g->x, g->y, g[-1].x, g[-1].y);
	}
	pose->glass = glass;
	return 0;
}

int basis_read_mirror(const struct basis_reader *r, const struct basis_chunk_entry *chunk,
		      struct basis_pose *pose)
{
	const struct basis_info_chunk *info = &r->basis->info;
	const struct basis_mirror *mirror;
	uint64_t before = 0;
	int same = 0; /* entries of this pixel */

	if (!chunk)
		return 0;
	if (chunk->bytes % sizeof(*mirror))
		return basis_damaged(r, "MIRR chunk of %llu bytes, expected a multiple of %zu",
				     (unsigned long long)chunk->bytes, sizeof(*mirror));
	mirror = (const void *)(r->data + chunk->offset);
	pose->mirror_count = chunk->bytes / sizeof(*mirror);
	for (size_t i = 0; i < pose->mirror_count; i++) {
		const struct basis_mirror *m = &mirror[i];
		const uint64_t rank = pixel_rank(r->basis, m->x, m->y);

		same = i && rank == before ? same + 1 : 1;
		if (m->x >= info->width || m->y >= info->height ||
		    m->level > (BASIS_MIRROR_LEVELS - 1) * BASIS_MIRROR_STEP ||
		    (i && rank < before) || same > BASIS_MIRROR_MOST)
			return basis_damaged(
				r,
				"mirror %zu is number %d of pixel %u, %u, at level %u: expected the order of tiles, rows and columns, %d of a pixel of %ux%u, and levels up to %d",
				i, same, m->x, m->y, m->level, BASIS_MIRROR_MOST, info->width,
				info->height, (BASIS_MIRROR_LEVELS - 1) * BASIS_MIRROR_STEP);
		before = rank;
	}
	pose->mirror = mirror;
	return 0;
}
