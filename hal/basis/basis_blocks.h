/* SPDX-License-Identifier: MIT */
/* Whether blocks are what a basis file may hold, before there is a file: those of a shard. */
#ifndef INLAY_HAL_BASIS_BASIS_BLOCKS_H
#define INLAY_HAL_BASIS_BASIS_BLOCKS_H

#include <stdbool.h>

#include "hal/basis/basis_writer.h"

/* The blocks of one layer of a tile, whose payloads lie one behind the other and have entry.bytes;
 * what entries say of tile and offset is not looked at. info: its sizes are in their ranges.
 * -EBADMSG: a rule of README.md is broken; -ENOMEM. */
int basis_check_tile(const struct basis_info_chunk *info, int tile, bool exact,
		     const struct basis_block_payload *blocks, int count);

#endif
