/* SPDX-License-Identifier: MIT */
/* Residual columns: the residuals that a fit's patterns leave of single lights, and of groups of
 * lights, quantised as in the file. Private to the encoder. */
#ifndef INLAY_BAKE_ENCODE_ENCODE_COLUMN_H
#define INLAY_BAKE_ENCODE_ENCODE_COLUMN_H

#include "bake/encode/encode_fit.h"
#include "hal/basis/basis_lines.h"

/* One column as stored: scale * value. */
struct column {
	int number; /* index of its light, or number of lights + index of its group */
	int channels, bits;
	bool second; /* it holds the residual that the light's column before it leaves */
	float scale;
	size_t bytes;			  /* bytes that its values take in a file */
	uint8_t code[BASIS_RECORD_LINES]; /* if bits is 8: codes of its lines (basis_lines.h) */
	int16_t *value;			  /* [channels * pixels] */
};

/* The columns of a part: those of lights, ascending, then those of groups. */
struct columns {
	struct column *column;
	int count, room;
	int16_t *value; /* memory of the columns' values */
};

/* A group has a column only if this many of its lights have one, as otherwise there is nothing in
 * common, and if it reaches at least this far, times the block's share of the cut: S is at most
 * BASIS_GROUP_MOST times the cut, so that it would never be read. */
#define COLUMN_GROUP_LIGHTS 2
#define COLUMN_GROUP_REACH (1.0 / BASIS_GROUP_MOST)

/* Returns the largest integer that a column of 8 or 16 bits stores. */
static inline int column_most(int bits)
{
	return bits == 8 ? INT8_MAX : INT16_MAX;
}

int columns_create(struct columns *columns, const struct encode_settings *settings);
void columns_free(struct columns *columns); /* zeroed is fine */

/*
 * Finds the columns that a fit needs at its ranks: none for a light whose residual is within its
 * limits, else the cheapest that bring it there, or the finest.
 */
void columns_find(struct columns *columns, const struct low_rank *fit);

#endif
