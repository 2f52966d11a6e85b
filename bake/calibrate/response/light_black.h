/* SPDX-License-Identifier: MIT */
/* The black level: the code value that is no light. */
#ifndef INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_BLACK_H
#define INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_BLACK_H

#include "bake/calibrate/estimate/verdict.h"
#include "hal/base/fault.h"
#include "hal/image/image.h"

struct light_black {
	double level;	   /* code value */
	double deviation;  /* of it, from how parts of the picture differ */
	double noise;	   /* standard deviation of one pixel */
	double channel[3]; /* of R, G, B alone */
	double lightest;   /* mean of the lightest of 8 x 8 parts of the picture */
	struct verdict verdict;
};

/* From a picture taken with the lens covered: its mean, or the lowest code where more than four in
 * ten values have it, as of cameras that cut noise off at the black level. -EINVAL: not an 8-bit
 * picture of 64 x 64 or more. */
int light_black_covered(struct light_black *black, const struct image *picture,
			struct fault *fault);

/*
 * From the darkest hundredth of the two shortest exposures of a scene: the level that does not
 * change with the time. Doubted where the pictures are alike or the longer one is darker, where the
 * darkest places change with the time or are not dark, and where the deviation is above one code.
 * -EINVAL: sizes that differ, not 8-bit, less than 64 x 64; -ENOMEM.
 */
int light_black_darkest(struct light_black *black, const struct image *shorter,
			const struct image *longer, struct fault *fault);

#endif
