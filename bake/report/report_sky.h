/* SPDX-License-Identifier: MIT */
/* Made surroundings, for reports without panoramas: skies and a room by formula, over a tiled
 * floor. */
#ifndef INLAY_BAKE_REPORT_REPORT_SKY_H
#define INLAY_BAKE_REPORT_REPORT_SKY_H

#include "hal/image/image.h"

/* "overcast", "sun", "lamps", NULL: from even light to light that comes from little of the sky. */
extern const char *const report_sky_names[];

/* Makes an equirectangular picture (hal/optics/panorama.h) of linear light, width x width / 2
 * pixels. -ENOMEM. */
int report_sky_make(struct image *image, int which, int width);

#endif
