/* SPDX-License-Identifier: MIT */
/* Decodes blocks from their payloads, so that the encoder can measure them. Private to the
 * encoder. */
#ifndef INLAY_BAKE_JUDGE_READER_H
#define INLAY_BAKE_JUDGE_READER_H

#include "bake/judge/part.h"
#include "hal/basis/basis_writer.h"

/* One block, decoded. */
struct read_block {
	const struct basis_block_payload *from;
	const uint16_t *number; /* [columns]: index of a light, or N + index of a group */
	const uint16_t *tint;	/* [3][pixels]; NULL: 1 */
	const float *scale;	/* [columns] */
	const float *pattern_scale;
	size_t at_light; /* index of [lights][patterns] in at_light */
	size_t row;	 /* index of [patterns + columns][channels][pixels] in rows */
};

/* Decoder of all blocks of one part. */
struct block_reader {
	const struct encode_settings *settings;
	const struct part *part;
	struct read_block *block;
	int count, room;
	double *at_light; /* each block's patterns, gathered to all lights */
	float *rows;	  /* each block's coefficients, then columns: integers, not scaled */
	size_t at_light_room, rows_room;
	bool *grouped; /* [2][groups]: whether a group has a column of one channel, of three */
};

void block_reader_free(struct block_reader *reader); /* zeroed is fine */

/* Decodes the blocks of a part. They must list all of its pixels. -ENOMEM. */
int block_reader_open(struct block_reader *reader, const struct encode_settings *settings,
		      const struct part *part, const struct basis_block_payload *block, int count);

/* Computes the values [3][PART_PIXELS] of the part for one light, with every column. */
void block_reader_light(const struct block_reader *reader, int light, double (*value)[PART_PIXELS]);

/* Computes the sum of X times value under a sky, without the columns that a frame leaves out. It is
 * in single precision, as the sums of struct part are. */
void block_reader_sky(const struct block_reader *reader, int sky, float (*sum)[PART_PIXELS]);

/* Returns the most by which rounding of a group's column may change any value, per unit of X. */
double block_reader_rounding(const struct block_reader *reader);

#endif
