/* SPDX-License-Identifier: MIT */
/*
 * A part taken apart: what all channels share, up to a tint (one channel), and the rest (three).
 * Either may be nothing. Each is patterns; what patterns leave wrong about a light is a column of
 * one or the other. Private to the encoder.
 */
#ifndef INLAY_BAKE_ENCODE_ENCODE_SPLIT_H
#define INLAY_BAKE_ENCODE_ENCODE_SPLIT_H

#include "bake/encode/encode_rank.h"
#include "hal/basis/basis_lines.h"

enum split_way {
	SPLIT_DIRECT, /* one channel, and a tint, for direct light; the rest is mostly what bounced
		       */
	SPLIT_TOTAL,  /* the same for all of it; the rest is what is of another hue */
	SPLIT_PLAIN,  /* all of it as it is: one channel if it has one, else three */
	SPLIT_WAYS
};

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

struct split {
	const struct part *part;
	enum split_way way;
	bool mono, colour; /* which of the two there are */
	bool tinted;
	float spent; /* of what may be left of a light, the share that short lines use up; 0: none
			is */
	/* Columns of one channel, of three: */
	bool whole[2]; /* 16 bits where 8 are not enough, not two of 8 */
	bool wide[2];  /* all in 16 bits */
	uint16_t tint[3][PART_PIXELS];
	float tint_share[3][PART_PIXELS]; /* tint / 2^15 */
	const float *mono_value;	  /* [lights][pixels] */
	const float *colour_value;	  /* [lights][3 * pixels] */
	float *own_mono, *own_colour;	  /* where they are not the part's own */
	size_t mono_room, colour_room, mono_left_room, colour_left_room;
	/* What the patterns of these ranks leave: */
	float *mono_left, *colour_left;
	int mono_rank, colour_rank;
	int most; /* patterns that were looked for; 0: not yet */
	struct rank_metric metric;
	struct rank_patterns mono_patterns, colour_patterns;
	struct rank_scratch scratch;
};

/* One column, as stored. */
struct split_column {
	enum column_form form;
	float scale;
	int16_t value[PART_ROWS];	  /* channel by channel */
	uint8_t code[BASIS_RECORD_LINES]; /* of 8 bits: how its lines are stored (basis_lines.h) */
	size_t bytes;			  /* that it takes in a file */
};

int split_create(struct split *split, const struct encode_settings *settings);
void split_free(struct split *split); /* zeroed is fine */

/* Whether it is worth trying: of a shadow in one channel and coloured bounce, the direct light is
 * all that channels share. */
bool split_possible(const struct part *part, enum split_way way);

/* Takes a part apart; nothing is found yet. -ENOMEM. */
int split_part(struct split *split, const struct encode_settings *settings, const struct part *part,
	       enum split_way way);

/* Finds the best patterns, at most so many of each, where lights count by weight [lights], which
 * must stay. -EDOM: they are no numbers. */
int split_find(struct split *split, const struct encode_settings *settings, const float *weight,
	       int most);

/* Sets what is left; ranks beyond what was found count as that. */
void split_set_ranks(struct split *split, int lights, int mono_rank, int colour_rank);

/* All that is left of a light, rows as the part has them. */
void split_left(const struct split *split, int light, float *left);

/* The one channel [pixels] that, tinted, comes nearest to three. */
void split_untint(const struct split *split, const float *three, float *one);

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
