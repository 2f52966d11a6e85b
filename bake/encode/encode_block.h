/* SPDX-License-Identifier: MIT */
/* Blocks as the file has them, and what they say. Private to the encoder. */
#ifndef INLAY_BAKE_ENCODE_ENCODE_BLOCK_H
#define INLAY_BAKE_ENCODE_ENCODE_BLOCK_H

#include "bake/encode/encode_search.h"

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
		const struct plan *plan, int tile);

/* One block of every light's column in 16 bits; nothing for a part that is 0 throughout, unless it
 * is of kind U. -ENOMEM. */
int block_build_exact(struct block_list *list, const struct encode_settings *settings,
		      const struct part *part, int tile);

/* A block of nothing, for a U whose D has something. */
int block_build_zero(struct block_list *list, const struct encode_settings *settings,
		     const struct part *part, int tile);

/* What some blocks of one part say, in double precision. */
struct block_reader {
	const struct encode_settings *settings;
	const struct part *part;
	const struct basis_block_payload *block;
	int count;
	double *at_light;    /* [patterns of all blocks][lights] */
	double *coefficient; /* [patterns of all blocks][PART_ROWS] */
	bool *grouped;	     /* [2][groups]: of which there are columns of one channel, of three */
	int patterns_room;
};

void block_reader_free(struct block_reader *reader); /* zeroed is fine */

/* -ENOMEM. */
int block_reader_open(struct block_reader *reader, const struct encode_settings *settings,
		      const struct part *part, const struct basis_block_payload *block, int count);

/* A light's values, every column used: [3][part's pixels]. */
void block_reader_light(const struct block_reader *reader, int light, double (*value)[PART_PIXELS]);

/* Sums over a sky's X, columns below the part's cut left out: [3][part's pixels]. */
void block_reader_sky(const struct block_reader *reader, int sky, double (*sum)[PART_PIXELS]);

/* What the columns of groups are rounded by, at most, per unit of light. */
double block_reader_rounding(const struct block_reader *reader);

#endif
