/* SPDX-License-Identifier: MIT */
/* Residual columns: what the patterns of a fit leave of single lights, and of groups of lights,
 * quantised as in the file. Private to the encoder. */
#ifndef INLAY_BAKE_ENCODE_ENCODE_COLUMN_H
#define INLAY_BAKE_ENCODE_ENCODE_COLUMN_H

#include "bake/encode/encode_fit.h"
#include "hal/basis/basis_lines.h"

/* One column as stored: scale * value. */
struct column {
	int number; /* of a light, or number of lights + that of a group */
	int channels, bits;
	bool second; /* of what the light's column before it leaves */
	float scale;
	size_t bytes;			  /* of the values in a file */
	uint8_t code[BASIS_RECORD_LINES]; /* of 8 bits: how its lines are stored (basis_lines.h) */
	int16_t *value;			  /* [channels * pixels] */
};

/* The columns of a part: those of lights, ascending, then those of groups. */
struct columns {
	struct column *column;
	int count, room;
	int16_t *value; /* memory of the columns' values */
};

/* Least lights with columns, and least reach (times the block's share of the cut), of a group that
 * has a column. Fewer columns have nothing in common; with less reach it is never read, as S is
 * small. */
#define COLUMN_GROUP_LIGHTS 2
#define COLUMN_GROUP_REACH (1.0 / BASIS_GROUP_MOST)

/* Largest integer that a column of so many bits stores. */
static inline int column_most(int bits)
{
	return bits == 8 ? INT8_MAX : INT16_MAX;
}

int columns_create(struct columns *columns, const struct encode_settings *settings);
void columns_free(struct columns *columns); /* zeroed is fine */

/*
 * Finds the columns that a fit needs at its ranks: none for a light whose residual is within its
 * limits, else the cheapest that bring it there, or the finest. short_share: the share of a
 * residual's limit that values of short lines may use up, 0..1; 0: no short lines.
 */
void columns_find(struct columns *columns, const struct fit *fit, float short_share);

#endif
