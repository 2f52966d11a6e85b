/* SPDX-License-Identifier: MIT */
/* What the encoder is given: the transport of a tile's pixels, the lights, and the errors asked
 * for. */
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
	int channels;	       /* of direct: 3, or 1 where all three are alike */
	const float *direct;   /* [pixels][channels][lights]: light of one surface; U: >= 0 */
	const float *bounce;   /* [pixels][3][lights]: light of several surfaces; NULL: none */
};

/* Largest error of the shown layer, in 8-bit sRGB levels. */
struct encode_target {
	double rms, max; /* under each sky of the ensemble, in each tile: RMS, and of any pixel */
	double cell;	 /* of any pixel under any single cell, alone or strong */
};

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
	double column_cut; /* of struct basis_info_chunk */
	bool exact;	   /* make the exact layer too */
			   /* All that is pointed to must outlive the encoder. */
};

/* What a pixel may be off by under a sky, in levels. */
static inline double encode_sky_most(const struct encode_settings *settings, int sky)
{
	const struct encode_target *target = &settings->target;

	return settings->ensemble->strong[sky] && target->cell > target->max ? target->cell
									     : target->max;
}

#endif
