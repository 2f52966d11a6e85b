/* SPDX-License-Identifier: MIT */
/* Decodes blocks from their payloads, in double precision, so that the encoder can measure what it
 * has made. Private to the encoder. */
#ifndef INLAY_BAKE_ENCODE_ENCODE_READER_H
#define INLAY_BAKE_ENCODE_ENCODE_READER_H

#include "bake/encode/encode_part.h"

/* Decoder of all blocks of one part. */
struct block_reader {
	const struct encode_settings *settings;
	const struct part *part;
	const struct basis_block_payload *block;
	int count;
	double *at_light;    /* [patterns of all blocks][lights] */
	double *coefficient; /* [patterns of all blocks][PART_ROWS] */
	bool *grouped;	     /* [2][groups]: groups that have a column, of one channel, of three */
	int patterns_room;
};

void block_reader_free(struct block_reader *reader); /* zeroed is fine */

/* -ENOMEM. */
int block_reader_open(struct block_reader *reader, const struct encode_settings *settings,
		      const struct part *part, const struct basis_block_payload *block, int count);

/* Decodes a light's values, with all columns: [3][part's pixels]. */
void block_reader_light(const struct block_reader *reader, int light, double (*value)[PART_PIXELS]);

/* Sums the values times a sky's X, without columns below the part's cut: [3][part's pixels]. */
void block_reader_sky(const struct block_reader *reader, int sky, double (*sum)[PART_PIXELS]);

/* Largest rounding error of the columns of groups, per unit of light. */
double block_reader_rounding(const struct block_reader *reader);

#endif
