/* SPDX-License-Identifier: MIT */
/*
 * A part taken apart: what all channels share, up to a tint (one channel), and the rest (three).
 * Either may be nothing. Each is patterns; what patterns leave wrong about a light is a column of
 * one or the other. Private to the encoder.
 */
#ifndef INLAY_BAKE_ENCODE_ENCODE_SPLIT_H
#define INLAY_BAKE_ENCODE_ENCODE_SPLIT_H

#include "bake/encode/encode_rank.h"

enum split_way {
	SPLIT_DIRECT, /* one channel, and a tint, for direct light; the rest is mostly what bounced
		       */
	SPLIT_TOTAL,  /* the same for all of it; the rest is what is of another hue */
	SPLIT_PLAIN,  /* all of it as it is: one channel if it has one, else three */
	SPLIT_WAYS
};

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

#endif
