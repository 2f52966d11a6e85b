/* SPDX-License-Identifier: MIT */
/*
 * Layout of a shard on disk, for shard.c and for tests that damage shards: the header, the plan's
 * arrays and texts (list_pieces() of shard.c), then for each pose one record a tile and one for its
 * peaks and its footprint.
 */
#ifndef INLAY_BAKE_TILES_SHARD_FORMAT_H
#define INLAY_BAKE_TILES_SHARD_FORMAT_H

#include "bake/tiles/finished_tile.h"
#include "bake/tiles/plan.h"

#define SHARD_MAGIC "INLAYSHD"
#define SHARD_PROGRAM_MAX 32
/* A pose's last record has this tile number; it holds the pose's peaks and footprint. */
#define SHARD_NO_TILE UINT32_MAX

struct shard_header {
	char magic[8];
	char program[SHARD_PROGRAM_MAX];
	uint32_t basis_version; /* BASIS_VERSION, as shards hold blocks like basis files */
	uint32_t account_bytes; /* sizeof(struct tile_account), to refuse shards of other builds */
	uint32_t index, count;
	uint32_t has_gather, has_names;
	struct basis_info_chunk info;
	uint64_t checksum; /* XXH3-64 of this header, with this field 0, and the plan */
};

/* The head of a record. The tile's account, pixels of glass, mirrors, block entries and payloads
 * follow it. */
struct shard_record {
	uint32_t tile;
	uint32_t shown, exact;
	uint32_t pose;
	uint32_t glass; /* number of pixels of glass */
	uint32_t mirrors;
	uint64_t bytes;	   /* number of bytes that follow */
	uint64_t checksum; /* XXH3-64 of this struct, with this field 0, and what follows */
};

#endif
