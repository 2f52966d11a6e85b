/* SPDX-License-Identifier: MIT */
/* The black level: the code value for no light. */
#ifndef INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_BLACK_H
#define INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_BLACK_H

#include "bake/calibrate/estimate/verdict.h"
#include "hal/base/fault.h"
#include "hal/image/image.h"

struct light_black {
	double level;	   /* code value */
	double deviation;  /* standard deviation of level, from how parts of the picture differ */
	double noise;	   /* standard deviation of one pixel */
	double channel[3]; /* level of R, G, B alone */
	double lightest;   /* mean of the lightest of 8 x 8 parts of the picture */
	struct verdict verdict;
};

/* Measures a picture taken with the lens covered: its mean, or the lowest code if more than four in
 * ten values have it, as with cameras that clip noise at the black level. -EINVAL: not an 8-bit
 * picture of 64 x 64 or more. */
int light_black_covered(struct light_black *black, const struct image *picture,
			struct fault *fault);

#endif
