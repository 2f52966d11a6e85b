/* SPDX-License-Identifier: MIT */
/* The background picture of all benchmarks and reports: gradients, edges and texture, from black to
 * white. */
#ifndef INLAY_HAL_MEASURE_BACKGROUND_H
#define INLAY_HAL_MEASURE_BACKGROUND_H

#include "hal/compositor/compositor.h"
#include "hal/frame/frame.h"

void background_fill(struct canvas *canvas);

/* The settings of all composites that are measured: sRGB before and after, with the object. */
struct compositor_settings background_settings(enum compositor_mode mode);

#endif
