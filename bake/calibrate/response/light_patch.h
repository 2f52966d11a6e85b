/* SPDX-License-Identifier: MIT */
/* A patch of a picture: its mean linear light, and whether it is one colour. */
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
	double deviation[3]; /* of it, by how its quarters differ */
	double uneven;	/* the largest difference of a quarter's mean from the patch's, relative */
	double clipped; /* share of pixels with a channel at 255 */
};

/* "x,y,width,height", or three or more corners "x,y x,y x,y ...". -EINVAL. */
int light_area_parse(struct light_area *area, const char *text, struct fault *fault);

/* Pixels whose centre lies in the area. An 8-bit picture is decoded by the curve; linear light is
 * taken as it is. -EINVAL: fewer than 16 pixels, or not all of it in the picture. */
int light_patch_measure(struct light_patch *patch, const struct image *picture,
			const struct light_area *area, const struct transfer_curve *curve,
			struct fault *fault);

#endif
