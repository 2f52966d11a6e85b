/* SPDX-License-Identifier: MIT */
/*
 * Renders the studio as a camera sees it, fast enough for video. Rays, albedo and steady light are
 * computed once for each pixel, with anti-aliasing; each frame adds the lanterns.
 */
#ifndef INLAY_DRIVERS_SIM_STUDIO_VIEW_H
#define INLAY_DRIVERS_SIM_STUDIO_VIEW_H

#include "drivers/sim/eye.h"

struct studio_view;

/* Computes everything that does not move; the caller destroys *view. 0 or -ENOMEM. */
int studio_view_create(struct studio_view **view, const struct sim_eye *eye);

/* Computes the mean radiance of each pixel at a time: rgb[height][width][3]. */
void studio_view_render(const struct studio_view *view, double time_s, float *rgb);

void studio_view_destroy(struct studio_view *view); /* NULL is harmless */

#endif
