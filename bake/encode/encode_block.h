/* SPDX-License-Identifier: MIT */
/* Blocks as the file has them. Private to the encoder. */
#ifndef INLAY_BAKE_ENCODE_ENCODE_BLOCK_H
#define INLAY_BAKE_ENCODE_ENCODE_BLOCK_H

#include "bake/encode/encode_plan.h"

/* Payloads that are used again for the next tile. */
struct block_list {
	struct basis_block_payload *block; /* [count] */
	struct block_room {
		void *data;
		size_t bytes;
	} * room;
	int count, places;
};

void block_list_free(struct block_list *list); /* zeroed is fine */

/* What the plan says, from a split whose ranks are set to it. -ENOMEM. */
int block_build(struct block_list *list, const struct search *search, const struct split *split,
		const struct encode_plan *plan, int tile);

/* One block of every light's column in 16 bits; nothing for a part that is 0 throughout, unless it
 * is of kind U. -ENOMEM. */
int block_build_exact(struct block_list *list, const struct encode_settings *settings,
		      const struct part *part, int tile);

/* A block of nothing, for a U whose D has something. */
int block_build_zero(struct block_list *list, const struct encode_settings *settings,
		     const struct part *part, int tile);

#endif
