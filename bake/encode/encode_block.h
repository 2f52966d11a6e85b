/* SPDX-License-Identifier: MIT */
/* Builds blocks from a fit and its columns, in the layout of the file. Private to the encoder. */
#ifndef INLAY_BAKE_ENCODE_ENCODE_BLOCK_H
#define INLAY_BAKE_ENCODE_ENCODE_BLOCK_H

#include "bake/encode/encode_column.h"
#include "hal/basis/basis_writer.h"

/* A list of blocks. Their memory is kept for the next tile. */
struct block_list {
	struct basis_block_payload *block; /* [count] */
	struct block_room {
		void *data;
		size_t bytes;
	} * room;
	int count, places; /* blocks in use, and elements of both arrays */
};

void block_list_free(struct block_list *list); /* zeroed is fine */

/* Adds the blocks that hold a fit's patterns, at its ranks, and the columns. -ENOMEM. */
int block_build(struct block_list *list, const struct low_rank *fit, const struct columns *columns,
		int tile);

/* Adds one block that has every light's column in 16 bits, for the exact layer. Adds none for a
 * part that is 0 everywhere, unless it is of kind U. -ENOMEM. */
int block_build_exact(struct block_list *list, const struct encode_settings *settings,
		      const struct part *part, int tile);

/* Adds a block of zeros, for a U without blocks whose D has some. -ENOMEM. */
int block_build_zero(struct block_list *list, const struct encode_settings *settings,
		     const struct part *part, int tile);

#endif
