/* SPDX-License-Identifier: MIT */
/* Residual columns: what the patterns of a split leave wrong about one light, as stored. Private to
 * the encoder. */
#ifndef INLAY_BAKE_ENCODE_ENCODE_COLUMN_H
#define INLAY_BAKE_ENCODE_ENCODE_COLUMN_H

#include "bake/encode/encode_split.h"
#include "hal/basis/basis_lines.h"

/* How a light's own column is stored, if it has one. Where 8 bits are not enough it is one of 16;
 * or, where frames may leave columns out, two of 8, the second of what the first leaves, which only
 * strong light needs. Where neither is enough, one of 16 and a second, of 8 or of 16. */
enum column_form {
	COLUMN_NONE,
	COLUMN_MONO8,
	COLUMN_MONO_REST, /* of 8 bits, too */
	COLUMN_MONO16,
	COLUMN_MONO_REST16,
	COLUMN_COLOUR8,
	COLUMN_COLOUR_REST,
	COLUMN_COLOUR16,
	COLUMN_COLOUR_REST16,
	COLUMN_FORMS
};

#define LIGHT_COLUMNS_MAX 2

/* The largest value that is stored. */
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

/* One column, as stored. */
struct split_column {
	enum column_form form;
	float scale;
	int16_t value[PART_ROWS];	  /* channel by channel */
	uint8_t code[BASIS_RECORD_LINES]; /* of 8 bits: how its lines are stored (basis_lines.h) */
	size_t bytes;			  /* that it takes in a file */
};

/* The cheapest columns that keep the light within the error asked for (the finest, whatever they
 * leave, when nothing else does). Returns how many: 1, or 2. left [LIGHT_COLUMNS_MAX][rows]: what
 * patterns leave; becomes what the first column leaves, and the second. */
int split_find_columns(const struct split *split, int light, float *left,
		       struct split_column column[LIGHT_COLUMNS_MAX]);

/* A column of column->form that says `from` [channels * pixels], rounded to nearest, and reaches at
 * least so far. */
void split_take_column(const struct split *split, const float *from, double reach,
		       struct split_column *column);

#endif
