/* SPDX-License-Identifier: MIT */
/* What a fisheye loses towards its rim, from a picture of something equally bright all over: an
 * integrating sphere, or a white diffuser on the lens. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_FALLOFF_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_FALLOFF_H

#include "bake/calibrate/estimate/verdict.h"
#include "hal/base/fault.h"
#include "hal/image/image.h"
#include "hal/optics/fisheye.h"

struct falloff {
	double v[FISHEYE_FALLOFF_TERMS]; /* of fisheye.h */
	double deviation[FISHEYE_FALLOFF_TERMS];
	double rim;    /* the share of light that the rim gets */
	double spread; /* standard deviation of what is equally far from the axis, of its light */
	struct verdict verdict;
};

/*
 * 8-bit pictures are taken as sRGB; what is white is left out, and so are the outermost pixels.
 * -EINVAL: the lens is none for a picture of this size; -ENOMEM.
 */
int falloff_find(struct falloff *falloff, const struct image *picture,
		 const struct fisheye_settings *lens, struct fault *fault);

#endif
