/* SPDX-License-Identifier: MIT */
/* Choice among the formats that a camera offers. */
#ifndef INLAY_HAL_DEVICE_CAMERA_CHOICE_H
#define INLAY_HAL_DEVICE_CAMERA_CHOICE_H

#include <stdbool.h>

#include "hal/frame/frame.h"

/* Merit of a format; larger is better; 0: the program does not decode it from cameras. size: the
 * format has the wanted size; rate: it has the wanted rate at that size. Formats with both come
 * first, then those with the size, then the rest. Among equals the cheaper conversion wins: full
 * colour without conversion, 4:2:2, 4:2:0, compressed, grey; then video, then depths. */
int camera_format_merit(enum pixel_format format, bool size, bool rate);

#endif
