/* SPDX-License-Identifier: MIT */
/* Falloff (vignetting) of a fisheye towards its rim, from a picture of something equally bright all
 * over: an integrating sphere, or a white diffuser on the lens. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_FALLOFF_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_FALLOFF_H

#include "bake/calibrate/estimate/verdict.h"
#include "hal/base/fault.h"
#include "hal/image/image.h"
#include "hal/optics/fisheye.h"

struct falloff {
	double v[FISHEYE_FALLOFF_TERMS]; /* coefficients as in fisheye.h */
	double deviation[FISHEYE_FALLOFF_TERMS];
	double rim;    /* brightness at the rim relative to the axis */
	double spread; /* standard deviation at equal distance from the axis, relative */
	struct verdict verdict;
};

/*
 * Fits the falloff. 8-bit pictures are decoded as sRGB; white areas and the outermost pixels are
 * left out. -EINVAL: the lens does not suit a picture of this size; -ENOMEM.
 */
int falloff_find(struct falloff *falloff, const struct image *picture,
		 const struct fisheye_settings *lens, struct fault *fault);

#endif
