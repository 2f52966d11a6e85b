/* SPDX-License-Identifier: MIT */
/*
 * The studio as a camera sees it, fast enough for video: what does not change (rays, paint, steady
 * light) is worked out once for each pixel, anti-aliased; a frame adds the lanterns.
 */
#ifndef INLAY_DRIVERS_SIM_STUDIO_VIEW_H
#define INLAY_DRIVERS_SIM_STUDIO_VIEW_H

#include "drivers/sim/eye.h"

struct studio_view;

/* 0 or -ENOMEM. Takes about half a second for 640x480. */
int studio_view_create(struct studio_view **view, const struct sim_eye *eye);

/* Mean radiance of each pixel at a time: rgb[height][width][3]. */
void studio_view_render(const struct studio_view *view, double time_s, float *rgb);

void studio_view_destroy(struct studio_view *view); /* NULL is harmless */

#endif
