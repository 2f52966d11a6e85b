/* SPDX-License-Identifier: MIT */
/*
 * A shard as it lies on disk, for who reads and writes it and for who damages it to see whether
 * that is noticed: the header, the plan's arrays and texts (list_pieces() of shard.c), and for each
 * pose one record a tile and one more.
 */
#ifndef INLAY_BAKE_TILES_SHARD_FORMAT_H
#define INLAY_BAKE_TILES_SHARD_FORMAT_H

#include "bake/tiles/finished_tile.h"
#include "bake/tiles/plan.h"

#define SHARD_MAGIC "INLAYSHD"
#define SHARD_PROGRAM_MAX 32
#define SHARD_NO_TILE UINT32_MAX /* of a pose's last record, which holds its peaks */

struct shard_header {
	char magic[8];
	char program[SHARD_PROGRAM_MAX];
	uint32_t basis_version; /* a shard holds blocks as basis files do */
	uint32_t account_bytes; /* sizeof(struct tile_account): of the same build, then */
	uint32_t index, count;
	uint32_t has_gather, has_names;
	struct basis_info_chunk info;
	uint64_t checksum; /* XXH3-64 of this (the field 0) and the plan */
};

/* Followed by the tile's account, what is seen through it, its blocks' entries, their payloads. */
struct shard_record {
	uint32_t tile;
	uint32_t shown, exact;
	uint32_t pose;
	uint32_t glass; /* pixels */
	uint32_t reserved;
	uint64_t bytes;	   /* of all that follows */
	uint64_t checksum; /* XXH3-64 of this (the field 0) and what follows */
};

#endif
