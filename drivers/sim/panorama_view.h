/* SPDX-License-Identifier: MIT */
/*
 * An HDR panorama as a camera sees it, turning about the vertical. Each pixel is the mean of as
 * many bilinear samples as it covers panorama pixels, 4x4 at most.
 */
#ifndef INLAY_DRIVERS_SIM_PANORAMA_VIEW_H
#define INLAY_DRIVERS_SIM_PANORAMA_VIEW_H

#include "drivers/sim/eye.h"
#include "hal/base/fault.h"

struct panorama_view;

/* The file must hold linear light, twice as wide as high. */
int panorama_view_create(struct panorama_view **view, const char *path, const struct sim_eye *eye,
			 struct fault *fault);

/* rgb[height][width][3]; the surrounding is turned by turn_rad, counter-clockwise from above. */
void panorama_view_render(const struct panorama_view *view, double turn_rad, float *rgb);

void panorama_view_destroy(struct panorama_view *view); /* NULL is harmless */

#endif
