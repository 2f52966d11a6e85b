/* SPDX-License-Identifier: MIT */
/* The pictures that ideal cameras would take of a panorama, or of the real scene under lamps. */
#ifndef INLAY_BAKE_TRUTH_TRUTH_VIEWS_H
#define INLAY_BAKE_TRUTH_TRUTH_VIEWS_H

#include "bake/truth/truth.h"
#include "hal/image/image.h"
#include "hal/optics/fisheye.h"

/* The panorama through the scene's camera, linear, averaged over each pixel. Errors
 * are those of truth_see(). */
int truth_background(const struct scene *scene, const struct panorama *panorama, struct image *out);

/* The upper half of the panorama as a perfect fisheye camera at the origin sees it, looking up:
 * equidistant, side x side pixels, each the mean radiance over its solid angle.
 * Errors are the same. */
int truth_fisheye(const struct panorama *panorama, int side, struct image *out);

/* A fisheye in the real scene. */
struct truth_eye {
	struct fisheye lens; /* of a picture of side x side pixels */
	struct v3 place;
	int side;
};

/* The real scene, without objects, as the fisheye or the scene's camera (eye NULL) sees it: its
 * stand-ins and ground, path traced, lamps, and the sky behind them. Linear, each pixel the mean
 * over its solid angle, times the lens's falloff. settings->samples is for the camera alone; a
 * fisheye needs fewer, except of lamps. -ENOMEM, or -errno of starting threads. */
int truth_see(const struct scene *scene, const struct sky *sky, const struct truth_eye *eye,
	      const struct truth_settings *settings, struct image *out);

#endif
