/* SPDX-License-Identifier: MIT */
/* The encoder's input: the transport of a tile's pixels, the lights, and the errors asked for. */
#ifndef INLAY_BAKE_JUDGE_SAMPLES_H
#define INLAY_BAKE_JUDGE_SAMPLES_H

#include <stdbool.h>
#include <stdint.h>

#include "bake/judge/ensemble.h"
#include "hal/basis/basis_groups.h"

/* Transport of one kind for some pixels of a tile, direct + bounce: t, v, d or u of basis_format.h,
 * not yet divided by the factors of X. */
struct encode_samples {
	enum basis_kind kind;
	int ground; /* index of the ground, for kind V; else 0 */
	int pixels;
	const uint16_t *pixel; /* y * BASIS_TILE + x, ascending */
	int channels;	       /* channels of direct: 3, or 1 if all three are alike */
	const float *direct;   /* [pixels][channels][lights]: light of one surface; U: >= 0 */
	const float *bounce;   /* [pixels][3][lights]: light of several surfaces; NULL: none */
};

/* The errors that the shown layer may have in each tile, in 8-bit sRGB levels. */
struct encode_target {
	double rms, max; /* RMS and largest error under each sky of the ensemble */
	double cell;	 /* largest error under any single cell, alone or strong */
};

/* All that is pointed to must outlive the encoder. */
struct encode_settings {
	int lights;
	const struct basis_light *light; /* [lights] */
	int grounds;
	const double *ground;		   /* [grounds][3][lights] */
	int coarse;			   /* K */
	const struct basis_coarse *gather; /* [lights]; NULL where coarse is lights */
	const struct basis_groups *groups; /* set by the encoder, from gather */
	const struct ensemble *ensemble;
	struct encode_target target;
	double column_cut; /* as in struct basis_info_chunk */
	bool exact;	   /* the exact layer is made too */
};

/* Returns the largest error that a pixel may have under a sky, in levels. */
static inline double encode_sky_most(const struct encode_settings *settings, int sky)
{
	const struct encode_target *target = &settings->target;

	return settings->ensemble->strong[sky] && target->cell > target->max ? target->cell
									     : target->max;
}

#endif
