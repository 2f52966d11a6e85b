/* SPDX-License-Identifier: MIT */
/*
 * The low-rank part of one set of samples. It is the sum of two bases: mono has one channel, which
 * is multiplied by a tint to give three, and colour has three channels. Either may be absent.
 * Private to the encoder.
 */
#ifndef INLAY_BAKE_ENCODE_ENCODE_FIT_H
#define INLAY_BAKE_ENCODE_ENCODE_FIT_H

#include "bake/encode/encode_rank.h"

struct low_rank {
	const struct encode_settings *settings;
	const struct part *part;
	bool mono, colour; /* tell which of the two exist */
	bool tinted;	   /* mono has a tint */
	bool found;	   /* fit_find() was called for this part */
	uint16_t tint[3][PART_PIXELS];
	float tint_share[3][PART_PIXELS]; /* tint / 2^15; 1 where there is no tint */
	const float *mono_value;	  /* [lights][pixels] */
	const float *colour_value;	  /* [lights][rows] */
	float *own_mono, *own_colour;	  /* their memory, where it is not the part's */
	struct rank_finder finder;
	struct rank_patterns mono_patterns, colour_patterns;
	float *tinted_rows; /* [RANK_MOST][rows]: mono's coefficients times the tint */
	int mono_rank, colour_rank;
	double excess;	  /* largest estimated error under a sky, as a multiple of the target */
	double cut_share; /* the blocks' share of the cut (basis_format.h) */
	float *left;	  /* [lights][rows]: residual after mono_rank and colour_rank patterns */
	size_t mono_room, colour_room, left_room;
};

int fit_create(struct low_rank *fit, const struct encode_settings *settings);
void fit_free(struct low_rank *fit); /* zeroed is fine */

/* Splits a part into mono and colour. -ENOMEM. */
int fit_begin(struct low_rank *fit, const struct part *part);

/* Finds the patterns that leave the least weighted squared error. -EDOM: weights are not finite. */
int fit_find(struct low_rank *fit);

/* Sets the ranks, lowered to the number of patterns found, and computes the residual. */
void fit_set_ranks(struct low_rank *fit, int mono_rank, int colour_rank);

/* Returns the residual [rows] of a light. */
static inline const float *fit_left(const struct low_rank *fit, int light)
{
	return fit->left + (size_t)light * (size_t)fit->part->rows;
}

/* Finds the channel one[pixels] that, times the tint, is nearest to three[3 * pixels] (least
 * squares). */
void fit_untint(const struct low_rank *fit, const float *three, float *one);

#endif
