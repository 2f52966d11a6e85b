/* SPDX-License-Identifier: MIT */
/*
 * The low-rank part of one set of samples, as the sum of two bases: mono, of one channel that all
 * three share up to a tint, and colour, of three channels. Either may be absent. Private to the
 * encoder.
 */
#ifndef INLAY_BAKE_ENCODE_ENCODE_FIT_H
#define INLAY_BAKE_ENCODE_ENCODE_FIT_H

#include "bake/encode/encode_rank.h"

struct fit {
	const struct encode_settings *settings;
	const struct part *part;
	bool mono, colour; /* which of the two exist */
	bool tinted;
	bool found; /* the patterns */
	uint16_t tint[3][PART_PIXELS];
	float tint_share[3][PART_PIXELS]; /* tint / 2^15; 1 where there is no tint */
	const float *mono_value;	  /* [lights][pixels] */
	const float *colour_value;	  /* [lights][rows] */
	float *own_mono, *own_colour;	  /* memory of these, where they are not the part's own */
	struct rank_finder finder;
	struct rank_patterns mono_patterns, colour_patterns;
	float *tinted_rows; /* [RANK_MOST][rows]: mono's coefficients times the tint */
	int mono_rank, colour_rank;
	double excess;	  /* estimated error under a sky over that asked for */
	double cut_share; /* of the blocks (basis_format.h) */
	float *left;	  /* [lights][rows]: residual after the patterns of these ranks */
	size_t mono_room, colour_room, left_room;
};

int fit_create(struct fit *fit, const struct encode_settings *settings);
void fit_free(struct fit *fit); /* zeroed is fine */

/* Splits a part in mono and colour, by its weights. -ENOMEM. */
int fit_begin(struct fit *fit, const struct part *part);

/* Finds the patterns that leave the least weighted squared error. -EDOM: weights are not finite. */
int fit_find(struct fit *fit);

/* Sets the ranks, lowered to the number of patterns found, and computes the residual. */
void fit_set_ranks(struct fit *fit, int mono_rank, int colour_rank);

/* Residual of a light: [rows]. */
static inline const float *fit_left(const struct fit *fit, int light)
{
	return fit->left + (size_t)light * (size_t)fit->part->rows;
}

/* Finds the channel [pixels] that, times the tint, is nearest to three channels (least squares). */
void fit_untint(const struct fit *fit, const float *three, float *one);

#endif
