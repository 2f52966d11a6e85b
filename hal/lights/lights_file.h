/* SPDX-License-Identifier: MIT */
/* A lights file: text, one line `r g b` (linear radiance, >= 0, finite) per light in dome order.
 * Blank lines and text from # on are ignored. */
#ifndef INLAY_HAL_LIGHTS_LIGHTS_FILE_H
#define INLAY_HAL_LIGHTS_LIGHTS_FILE_H

#include "hal/base/fault.h"

/* Read and write count lights. 0 or -errno; -EINVAL: the file has not exactly count colours, and
 * the fault names the line. */
int lights_file_read(const char *path, float (*radiance)[3], int count, struct fault *fault);
int lights_file_write(const char *path, const float (*radiance)[3], int count, struct fault *fault);

#endif
