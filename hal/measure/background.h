/* SPDX-License-Identifier: MIT */
/* The background picture of all benchmarks and reports: gradients, edges and texture, from black to
 * white. */
#ifndef INLAY_HAL_MEASURE_BACKGROUND_H
#define INLAY_HAL_MEASURE_BACKGROUND_H

#include "hal/frame/frame.h"

void background_fill(struct canvas *canvas);

#endif
