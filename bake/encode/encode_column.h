/* SPDX-License-Identifier: MIT */
/* Residual columns: what the patterns of a split leave of one light, quantised as in the file.
 * Private to the encoder. */
#ifndef INLAY_BAKE_ENCODE_ENCODE_COLUMN_H
#define INLAY_BAKE_ENCODE_ENCODE_COLUMN_H

#include "bake/encode/encode_split.h"
#include "hal/basis/basis_lines.h"

/*
 * How a light's column is stored. Where 8 bits are not enough, it has one column of 16 bits; or,
 * where frames may leave columns out, two of 8: the second is the residual of the first, which only
 * strong light needs. Where neither is enough, it has one of 16 and a second of 8 or 16.
 */
enum column_form {
	COLUMN_NONE,
	COLUMN_MONO8,
	COLUMN_MONO_REST, /* second column, of 8 bits */
	COLUMN_MONO16,
	COLUMN_MONO_REST16,
	COLUMN_COLOUR8,
	COLUMN_COLOUR_REST,
	COLUMN_COLOUR16,
	COLUMN_COLOUR_REST16,
	COLUMN_FORMS
};

#define LIGHT_COLUMNS_MAX 2

/* Largest integer that is stored. */
static inline int column_most(enum column_form form)
{
	return form == COLUMN_MONO16 || form == COLUMN_MONO_REST16 || form == COLUMN_COLOUR16 ||
			       form == COLUMN_COLOUR_REST16
		       ? 32767
		       : 127;
}

static inline int column_channels(enum column_form form)
{
	return form < COLUMN_COLOUR8 ? 1 : 3;
}

/* One column as stored: scale * value. */
struct split_column {
	enum column_form form;
	float scale;
	int16_t value[PART_ROWS];	  /* channel by channel */
	uint8_t code[BASIS_RECORD_LINES]; /* of 8 bits: how its lines are stored (basis_lines.h) */
	size_t bytes;			  /* in a file */
};

/* Finds the cheapest columns that keep a light within the error asked for, or else the finest ones.
 * Returns how many, 1 or 2. left [LIGHT_COLUMNS_MAX][rows]: the residual of the patterns; becomes
 * the residuals after the first column and after the second. */
int split_find_columns(const struct split *split, int light, float *left,
		       struct split_column column[LIGHT_COLUMNS_MAX]);

/* Quantises `from` [channels * pixels] to a column of column->form, rounded to nearest. reach:
 * least reach of the column. */
void split_take_column(const struct split *split, const float *from, double reach,
		       struct split_column *column);

#endif
