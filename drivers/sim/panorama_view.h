/* SPDX-License-Identifier: MIT */
/*
 * Renders an HDR panorama, turned about the vertical axis, as a camera sees it. Each pixel is the
 * mean of bilinear samples, one for each panorama pixel that it covers, at most 4x4.
 */
#ifndef INLAY_DRIVERS_SIM_PANORAMA_VIEW_H
#define INLAY_DRIVERS_SIM_PANORAMA_VIEW_H

#include "drivers/sim/eye.h"
#include "hal/base/fault.h"

struct panorama_view;

/* Reads the panorama and computes the samples of every pixel. The file must hold linear light,
 * twice as wide as high. The caller destroys *view. 0 or -errno with a fault. */
int panorama_view_create(struct panorama_view **view, const char *path, const struct sim_eye *eye,
			 struct fault *fault);

/* Renders rgb[height][width][3]. The panorama is turned by turn_rad, counter-clockwise from
 * above. */
void panorama_view_render(const struct panorama_view *view, double turn_rad, float *rgb);

void panorama_view_destroy(struct panorama_view *view); /* NULL is harmless */

#endif
