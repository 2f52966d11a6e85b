/* SPDX-License-Identifier: MIT */
/* A background to composite into: the same one everywhere, with gradients, edges and texture, from
 * black to white. */
#ifndef INLAY_HAL_MEASURE_BACKGROUND_H
#define INLAY_HAL_MEASURE_BACKGROUND_H

#include "hal/frame/frame.h"

void background_fill(struct canvas *canvas);

#endif
