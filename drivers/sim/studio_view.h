/* SPDX-License-Identifier: MIT */
/*
 * Renders the studio as a camera sees it, fast enough for video. Rays, albedo and steady light are
 * computed once for each pixel, with anti-aliasing; each frame adds the lanterns.
 */
#ifndef INLAY_DRIVERS_SIM_STUDIO_VIEW_H
#define INLAY_DRIVERS_SIM_STUDIO_VIEW_H

#include "drivers/sim/eye.h"
#include "drivers/sim/studio.h"

struct studio_view;

/* Computes everything that does not move; the caller destroys *view. 0 or -ENOMEM. */
int studio_view_create(struct studio_view **view, const struct sim_eye *eye);

/* Computes the mean radiance of each pixel: rgb[height][width][3]. */
void studio_view_render(const struct studio_view *view, const struct studio_lamps *lamps,
			float *rgb);

/* What a pixel sees of the room. */
struct studio_ground {
	double point[3], normal[3]; /* of its first sample */
	double paint[3];	    /* mean albedo / pi over the pixel */
};

struct studio_ground studio_view_ground(const struct studio_view *view, int x, int y);
const struct sim_eye *studio_view_eye(const struct studio_view *view);

/* Multiplies the light of a pixel that sees surfaces alone, no source of light. */
void studio_view_paint(struct studio_view *view, int x, int y, const double factor[3]);

void studio_view_destroy(struct studio_view *view); /* NULL is harmless */

/* Computes the depth of the empty room along the axis of a camera that is no fisheye,
 * z[height][width] in m; 0: a lantern, which blinds a depth camera. */
void studio_view_depth(const struct studio_view *view, const struct studio_lamps *lamps, float *z);

#endif
