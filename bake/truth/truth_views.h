/* SPDX-License-Identifier: MIT */
/* The pictures that ideal cameras would take of a panorama. */
#ifndef INLAY_BAKE_TRUTH_TRUTH_VIEWS_H
#define INLAY_BAKE_TRUTH_TRUTH_VIEWS_H

#include "bake/scene/scene.h"
#include "hal/image/image.h"
#include "hal/optics/panorama.h"

/* The panorama through the scene's camera, linear, averaged over each pixel. -ENOMEM. */
int truth_background(const struct scene *scene, const struct panorama *panorama, struct image *out);

/* The upper half of the panorama as a perfect fisheye camera at the origin sees it, looking up:
 * equidistant, side x side pixels, each the mean radiance over its solid angle. -ENOMEM. */
int truth_fisheye(const struct panorama *panorama, int side, struct image *out);

#endif
