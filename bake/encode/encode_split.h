/* SPDX-License-Identifier: MIT */
/*
 * A part split into mono, one channel that all three share up to a tint, and colour, the remaining
 * three channels. Either may be absent. Each has a low-rank basis of its own; the residual of a
 * light is stored as a column of mono or of colour. Private to the encoder.
 */
#ifndef INLAY_BAKE_ENCODE_ENCODE_SPLIT_H
#define INLAY_BAKE_ENCODE_ENCODE_SPLIT_H

#include "bake/encode/encode_rank.h"

enum split_way {
	SPLIT_DIRECT, /* mono is direct light; colour is mostly bounced light */
	SPLIT_TOTAL,  /* mono is all light; colour is what has another hue */
	SPLIT_PLAIN,  /* no split: mono if the part has one channel, else colour */
	SPLIT_WAYS
};

struct split {
	const struct part *part;
	enum split_way way;
	bool mono, colour; /* which of the two exist */
	bool tinted;
	float spent; /* share of a residual's limit that short lines may use; 0: no short lines */
	/* Columns of mono, of colour: */
	bool whole[2]; /* where 8 bits are not enough: one column of 16, not two of 8 */
	bool wide[2];  /* all columns in 16 bits */
	uint16_t tint[3][PART_PIXELS];
	float tint_share[3][PART_PIXELS]; /* tint / 2^15 */
	const float *mono_value;	  /* [lights][pixels] */
	const float *colour_value;	  /* [lights][3 * pixels] */
	float *own_mono, *own_colour;	  /* memory of these, where they are not the part's own */
	size_t mono_room, colour_room, mono_left_room, colour_left_room;
	/* Residual after the patterns of these ranks: */
	float *mono_left, *colour_left;
	int mono_rank, colour_rank;
	int most; /* patterns that were searched for; 0: not yet */
	struct rank_metric metric;
	struct rank_patterns mono_patterns, colour_patterns;
	struct rank_scratch scratch;
};

int split_create(struct split *split, const struct encode_settings *settings);
void split_free(struct split *split); /* zeroed is fine */

/* Tells whether a way is worth trying for a part. In a shadow of one channel with coloured bounced
 * light, channels share the direct light only. */
bool split_possible(const struct part *part, enum split_way way);

/* Splits a part; its patterns are not yet found. -ENOMEM. */
int split_part(struct split *split, const struct encode_settings *settings, const struct part *part,
	       enum split_way way);

/* Finds the best patterns, at most `most` each for mono and colour. weight [lights] is the weight
 * of squared errors, and must stay in memory. -EDOM: weights are not finite. */
int split_find(struct split *split, const struct encode_settings *settings, const float *weight,
	       int most);

/* Computes the residual for these ranks. Ranks above the number of patterns found are lowered. */
void split_set_ranks(struct split *split, int lights, int mono_rank, int colour_rank);

/* Residual of a light, mono and colour together: left [rows of the part]. */
void split_left(const struct split *split, int light, float *left);

/* Finds the channel [pixels] that, times the tint, is nearest to three channels (least squares). */
void split_untint(const struct split *split, const float *three, float *one);

#endif
