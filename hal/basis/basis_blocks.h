/* SPDX-License-Identifier: MIT */
/* Checks the blocks of a basis file: of a whole layer, or of a tile that is not in a file yet
 * (bake/tiles/shard.h). */
#ifndef INLAY_HAL_BASIS_BASIS_BLOCKS_H
#define INLAY_HAL_BASIS_BASIS_BLOCKS_H

#include <stdbool.h>

#include "hal/basis/basis_writer.h"

struct basis_layer;
struct basis_reader;

/* Checks the blocks of one layer of a tile. Their payloads are contiguous and entry.bytes long;
 * entry.tile and entry.offset are ignored. The sizes in info must be in their ranges. -EBADMSG: a
 * rule of README.md is broken; -ENOMEM. */
int basis_check_tile(const struct basis_info_chunk *info, int tile, bool exact,
		     const struct basis_block_payload *blocks, int count);

/* ---- private to hal/basis ---- */

/* Block list and payloads of a layer, as found in the file. */
struct basis_blocks_chunk {
	const struct basis_block_entry *entries;
	size_t count;
	const uint8_t *data;
	size_t data_bytes;
	int pose;
	bool exact;
};

/* Checks the list alone, of contiguous payloads: all that basis_layout() needs is in its range, and
 * data_bytes is right. -EBADMSG. */
int basis_check_shapes(const struct basis_reader *reader, const struct basis_blocks_chunk *chunk);

/* Checks every block and fills the layer. -EBADMSG, -ENOMEM. */
int basis_read_blocks(const struct basis_reader *reader, const struct basis_blocks_chunk *chunk,
		      struct basis_layer *layer);

#endif
