/* SPDX-License-Identifier: MIT */
/* A lights file: text, one `r g b` (linear radiance, >= 0, finite) a line in dome order; blank
 * lines and lines from # on are skipped. */
#ifndef INLAY_HAL_LIGHTS_LIGHTS_FILE_H
#define INLAY_HAL_LIGHTS_LIGHTS_FILE_H

#include "hal/base/fault.h"

/* Exactly count lines of colours are expected; a fault names the line otherwise. */
int lights_file_read(const char *path, float (*radiance)[3], int count, struct fault *fault);
int lights_file_write(const char *path, const float (*radiance)[3], int count, struct fault *fault);

#endif
