/* SPDX-License-Identifier: MIT */
/*
 * Samples of a static scene in several exposures: uniform blocks of pixels over the whole range of
 * code values, each with its mean and variance.
 */
#ifndef INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_SAMPLES_H
#define INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_SAMPLES_H

#include <stdbool.h>

#include "hal/base/fault.h"
#include "hal/image/image.h"

#define LIGHT_EXPOSURES_MAX 32
#define LIGHT_BLOCK 8 /* px, the side of a block */

struct light_sample {
	int channel; /* 0..2: R, G, B */
	int x, y;    /* of the block's upper left corner, px */
	/* By exposure, in code values from the black level over 255 - black: */
	double mean[LIGHT_EXPOSURES_MAX];
	double noise[LIGHT_EXPOSURES_MAX];    /* variance of one pixel, without rounding */
	double variance[LIGHT_EXPOSURES_MAX]; /* variance of the mean, with rounding */
	bool good[LIGHT_EXPOSURES_MAX];	      /* neither clipped nor dark */
};

struct light_samples {
	int exposures;
	double black; /* code value for no light */
	int white;    /* code value from which pixels are clipped */
	struct light_sample *sample;
	int count, room;
	/* Shares of all blocks and channels, 0..1, by exposure. */
	double clipped[LIGHT_EXPOSURES_MAX], dark[LIGHT_EXPOSURES_MAX];
};

/*
 * Collects samples from pictures[exposures], 8-bit and of one size. Blocks with a pixel at 255, or
 * in a plateau at the upper end of what the camera gives, are clipped; those whose mean is within
 * three deviations of a pixel of the black level are dark. Of the blocks that are good in two
 * exposures or more the most uniform ones of each channel are kept, over all code values. -EINVAL:
 * different sizes, a picture that is not 8-bit, a number of exposures or a black level out of
 * range; -ENOMEM.
 */
int light_samples_create(struct light_samples *samples, const struct image *const *pictures,
			 int exposures, double black, struct fault *fault);

/* The code of no light, if a plateau at the lower end of a picture shows it; else 0. */
double light_darkest_code(const struct image *picture);

void light_samples_free(struct light_samples *samples); /* idempotent; zeroed is fine */

#endif
