/* SPDX-License-Identifier: MIT */
/* Decodes blocks from their payloads, in double precision, so that the encoder can measure what it
 * has made. Private to the encoder. */
#ifndef INLAY_BAKE_JUDGE_READER_H
#define INLAY_BAKE_JUDGE_READER_H

#include "bake/judge/part.h"
#include "hal/basis/basis_writer.h"

/* One block, decoded. */
struct read_block {
	const struct basis_block_payload *from;
	const uint16_t *number; /* [columns]: of lights, and N + those of groups */
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
	double *at_light; /* patterns at each light */
	float *rows;	  /* coefficients, then columns: integers, in units of their scales */
	size_t at_light_room, rows_room;
	bool *grouped; /* [2][groups]: groups that have a column, of one channel, of three */
};

void block_reader_free(struct block_reader *reader); /* zeroed is fine */

/* The blocks must list all pixels of the part. -ENOMEM. */
int block_reader_open(struct block_reader *reader, const struct encode_settings *settings,
		      const struct part *part, const struct basis_block_payload *block, int count);

/* Values of the part under a light alone, every column used: value [3][PART_PIXELS]. */
void block_reader_light(const struct block_reader *reader, int light, double (*value)[PART_PIXELS]);

/* Sum of X times values under a sky, without the columns that a frame leaves out. In single
 * precision, as the sums of struct part are. */
void block_reader_sky(const struct block_reader *reader, int sky, float (*sum)[PART_PIXELS]);

/* What rounding a group's column may change any value by, per unit of X. */
double block_reader_rounding(const struct block_reader *reader);

#endif
