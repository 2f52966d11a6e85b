/* SPDX-License-Identifier: MIT */
/* Blocks decoded again, in double precision. Private to the encoder. */
#ifndef INLAY_BAKE_ENCODE_ENCODE_READER_H
#define INLAY_BAKE_ENCODE_ENCODE_READER_H

#include "bake/encode/encode_part.h"

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
