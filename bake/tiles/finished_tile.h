/* SPDX-License-Identifier: MIT */
/* A rendered and encoded tile: its blocks for the basis file, and its statistics. */
#ifndef INLAY_BAKE_TILES_FINISHED_TILE_H
#define INLAY_BAKE_TILES_FINISHED_TILE_H

#include "bake/judge/ensemble.h"
#include "hal/basis/basis_writer.h"

/* Statistics of a tile. Shards hold the struct byte for byte, so it has no pointers. */
struct tile_account {
	struct ensemble_error error;
	double object_error, ratio_error; /* bounds, as in struct basis_info_chunk */
	double noise_square;		  /* sum of squared standard errors, in 8-bit levels */
	int64_t noise_count;		  /* number of these */
	uint64_t rays;
	uint16_t coverage[BASIS_TILE * BASIS_TILE]; /* [y][BASIS_TILE]; 65535 = 1 */
	/* As in basis_places.h; negative: not known. */
	float distance[BASIS_SURFACES][BASIS_TILE * BASIS_TILE];
};

struct finished_tile {
	int pose, tile;			    /* indices */
	int shown, exact;		    /* number of blocks of either layer */
	struct basis_block_payload *blocks; /* shown ones, exact ones, then their payloads */
	int glass_count;
	struct basis_glass *glass;
	int mirror_count;
	struct basis_mirror *mirror;
	struct tile_account account;
	double seconds; /* time it took to make in this run; files do not have it */
};

/* Returns the bytes of the payloads of count blocks. */
size_t finished_tile_bytes(const struct basis_block_payload *blocks, int count);

/* Copies the blocks of both layers into one piece of memory. -ENOMEM. */
int finished_tile_keep(struct finished_tile *tile, const struct basis_block_payload *shown,
		       int shown_count, const struct basis_block_payload *exact, int exact_count);
/* Copies the pixels that are seen through glass. -ENOMEM. */
int finished_tile_keep_glass(struct finished_tile *tile, const struct basis_glass *glass,
			     int count);
/* Copies what mirrors the sky. -ENOMEM. */
int finished_tile_keep_mirror(struct finished_tile *tile, const struct basis_mirror *mirror,
			      int count);
void finished_tile_free(struct finished_tile *tile); /* idempotent; zeroed is fine */

#endif
