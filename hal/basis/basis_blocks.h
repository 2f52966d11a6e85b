/* SPDX-License-Identifier: MIT */
/* Whether blocks are what a basis file may hold, before there is a file: those of a shard. */
#ifndef INLAY_HAL_BASIS_BASIS_BLOCKS_H
#define INLAY_HAL_BASIS_BASIS_BLOCKS_H

#include <stdbool.h>

#include "hal/basis/basis_writer.h"

struct basis_layer;
struct basis_reader;

/* The blocks of one layer of a tile, whose payloads lie one behind the other and have entry.bytes;
 * what entries say of tile and offset is not looked at. info: its sizes are in their ranges.
 * -EBADMSG: a rule of README.md is broken; -ENOMEM. */
int basis_check_tile(const struct basis_info_chunk *info, int tile, bool exact,
		     const struct basis_block_payload *blocks, int count);

/* ---- private to hal/basis ---- */

/* A layer's block list and payloads, as found in the file. */
struct basis_blocks_chunk {
	const struct basis_block_entry *entries;
	size_t count;
	const uint8_t *data;
	size_t data_bytes;
	int pose;
	bool exact;
};

/* Checks the list alone, of payloads that lie one behind the other: whatever basis_layout() asks
 * for is in its range, and data_bytes is right. -EBADMSG. */
int basis_check_shapes(const struct basis_reader *reader, const struct basis_blocks_chunk *chunk);

/* Checks every block of a layer and fills it. -EBADMSG, -ENOMEM. */
int basis_read_blocks(const struct basis_reader *reader, const struct basis_blocks_chunk *chunk,
		      struct basis_layer *layer);

#endif
