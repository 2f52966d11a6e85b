/* SPDX-License-Identifier: MIT */
/* Measures a patch of a picture: its mean linear light, and whether it is of one brightness. */
#ifndef INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_PATCH_H
#define INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_PATCH_H

#include "hal/base/fault.h"
#include "hal/colour/transfer.h"
#include "hal/image/image.h"

#define LIGHT_CORNERS_MAX 16

struct light_area {
	double corner[LIGHT_CORNERS_MAX][2]; /* px, a polygon */
	int corners;
};

struct light_patch {
	int pixels;
	double mean[3];	     /* linear light */
	double deviation[3]; /* standard deviation of mean, from how its quarters differ */
	double uneven;	     /* largest relative difference of a quarter's mean from the patch's */
	double clipped;	     /* share of pixels with a channel at 255 */
};

/* Parses "x,y,width,height", or three or more corners "x,y x,y x,y ...". -EINVAL. */
int light_area_parse(struct light_area *area, const char *text, struct fault *fault);

/* Measures the pixels whose centre lies in the area. An 8-bit picture is decoded by the curve;
 * linear light is used as it is. -EINVAL: fewer than 16 pixels, or the area is not fully in the
 * picture. */
int light_patch_measure(struct light_patch *patch, const struct image *picture,
			const struct light_area *area, const struct transfer_curve *curve,
			struct fault *fault);

#endif
