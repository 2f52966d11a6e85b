/* SPDX-License-Identifier: MIT */
/* How long a camera says that it exposed a picture. */
#ifndef INLAY_BAKE_CALIBRATE_BRACKET_LIGHT_EXIF_H
#define INLAY_BAKE_CALIBRATE_BRACKET_LIGHT_EXIF_H

#include "hal/base/fault.h"

/* Reads the exposure of a JPEG from its EXIF data: seconds, times ISO / 100, over the square of the
 * f-number, as far as they are there. -ENODATA: it has no exposure time; the fault names the
 * file. */
int light_exif_exposure(const char *path, double *exposure, struct fault *fault);

#endif
