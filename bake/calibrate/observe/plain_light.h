/* SPDX-License-Identifier: MIT */
/* A picture's light alone. */
#ifndef INLAY_BAKE_CALIBRATE_OBSERVE_PLAIN_LIGHT_H
#define INLAY_BAKE_CALIBRATE_OBSERVE_PLAIN_LIGHT_H

#include "hal/image/image.h"

/* [height][width], linear, of the three channels together; 8-bit pictures are taken as sRGB, of
 * which 1 is the most. Freed by the caller; NULL: out of memory. */
float *plain_light(const struct image *picture);

#endif
