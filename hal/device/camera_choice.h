/* SPDX-License-Identifier: MIT */
/* Which of the formats that a camera offers serves best. */
#ifndef INLAY_HAL_DEVICE_CAMERA_CHOICE_H
#define INLAY_HAL_DEVICE_CAMERA_CHOICE_H

#include <stdbool.h>

#include "hal/frame/frame.h"

/* The larger the better; 0: no camera's format that is decoded. One with the wanted size and rate
 * goes before one with the size alone, and that before any other; among equals the one that is
 * cheaper to convert: full colour without conversion, then halved chroma, quartered chroma,
 * compressed, grey. The rate is that at the wanted size. */
int camera_format_merit(enum pixel_format format, bool size, bool rate);

#endif
