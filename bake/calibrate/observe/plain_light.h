/* SPDX-License-Identifier: MIT */
/* A picture reduced to one linear brightness per pixel. */
#ifndef INLAY_BAKE_CALIBRATE_OBSERVE_PLAIN_LIGHT_H
#define INLAY_BAKE_CALIBRATE_OBSERVE_PLAIN_LIGHT_H

#include "hal/image/image.h"

/* Returns [height][width]: the mean of the three channels in linear light. 8-bit pictures are
 * decoded as sRGB, white is 1. The caller frees the array; NULL: out of memory. */
float *plain_light(const struct image *picture);

#endif
