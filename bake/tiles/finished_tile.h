/* SPDX-License-Identifier: MIT */
/* A tile that is rendered and encoded: what a basis file takes of it, and what is counted. */
#ifndef INLAY_BAKE_TILES_FINISHED_TILE_H
#define INLAY_BAKE_TILES_FINISHED_TILE_H

#include "bake/encode/ensemble.h"
#include "hal/basis/basis_writer.h"

/* Written to shards as it stands: no pointers. */
struct tile_account {
	struct ensemble_error error;
	double object_error, ratio_error; /* bounds, as in struct basis_info_chunk */
	double noise_square;
	int64_t noise_count;
	uint64_t rays;
	uint16_t coverage[BASIS_TILE * BASIS_TILE]; /* [y][BASIS_TILE] */
};

struct finished_tile {
	int pose, tile;
	int shown, exact;		    /* blocks of either layer */
	struct basis_block_payload *blocks; /* shown ones, exact ones, then their payloads */
	int glass_count;
	struct basis_glass *glass;
	struct tile_account account;
};

/* Bytes of the payloads of count blocks. */
size_t finished_tile_bytes(const struct basis_block_payload *blocks, int count);

/* Copies the blocks of both layers into one piece of memory. -ENOMEM. */
int finished_tile_keep(struct finished_tile *tile, const struct basis_block_payload *shown,
		       int shown_count, const struct basis_block_payload *exact, int exact_count);
/* Copies what is seen through the object. -ENOMEM. */
int finished_tile_keep_glass(struct finished_tile *tile, const struct basis_glass *glass,
			     int count);
void finished_tile_free(struct finished_tile *tile); /* idempotent; zeroed is fine */

#endif
