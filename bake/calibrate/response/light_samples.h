/* SPDX-License-Identifier: MIT */
/*
 * Places of a static scene in several exposures: blocks of pixels that are uniform, over the whole
 * range of code values, each with its mean and how well that is known.
 */
#ifndef INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_SAMPLES_H
#define INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_SAMPLES_H

#include <stdbool.h>

#include "hal/base/fault.h"
#include "hal/image/image.h"

#define LIGHT_EXPOSURES_MAX 16
#define LIGHT_BLOCK 8 /* px, the side of a block */

struct light_sample {
	int channel; /* 0..2: R, G, B */
	int x, y;    /* of the block's upper left corner, px */
	/* By exposure: code values over 255 - black, from the black level. */
	double mean[LIGHT_EXPOSURES_MAX];
	double noise[LIGHT_EXPOSURES_MAX];    /* variance of one pixel, rounding left out */
	double variance[LIGHT_EXPOSURES_MAX]; /* of the mean, with what rounding leaves */
	bool good[LIGHT_EXPOSURES_MAX];	      /* neither clipped nor lost in the dark */
};

struct light_samples {
	int exposures;
	double black; /* code value that is no light */
	struct light_sample *sample;
	int count, room;
	/* Shares of all blocks and channels, 0..1, by exposure. */
	double clipped[LIGHT_EXPOSURES_MAX], dark[LIGHT_EXPOSURES_MAX];
};

/*
 * pictures[exposures]: 8-bit, of one size. Blocks with a pixel at 255 are clipped; those
 * whose mean is within three deviations of a pixel of the black level are dark. Of the blocks that
 * are good in two exposures or more the most uniform of each channel are kept, over all code
 * values. -EINVAL: sizes that differ, a picture that is not 8-bit, a number of exposures or a black
 * level out of range; -ENOMEM.
 */
int light_samples_create(struct light_samples *samples, const struct image *const *pictures,
			 int exposures, double black, struct fault *fault);
void light_samples_free(struct light_samples *samples); /* idempotent; zeroed is fine */

#endif
