/* SPDX-License-Identifier: MIT */
/*
 * Merges exposures of a static scene into one picture of linear light:
 *     L = sum_j w_j f(u_j) / t_j / sum_j w_j,   w_j = t_j g(u_j)
 * Photon noise makes the weight proportional to the time. g is pixel_believed() of
 * hal/lights/pixel_noise.h, which falls smoothly to 0 towards white, and falls to 0 at black.
 * Units: light that gives white in an exposure of time 1 is 1.
 */
#ifndef INLAY_BAKE_CALIBRATE_BRACKET_LIGHT_MERGE_H
#define INLAY_BAKE_CALIBRATE_BRACKET_LIGHT_MERGE_H

#include "hal/base/fault.h"
#include "hal/colour/transfer.h"
#include "hal/image/image.h"

struct light_merged {
	struct image picture; /* f32 */
	double clipped, dark; /* shares of values that are so in all exposures: bounds alone */
};

/* pictures[exposures]: 8-bit, of one size; times > 0. The caller frees the picture. -ENOMEM. */
int light_merge(struct light_merged *merged, const struct image *pictures, const double *times,
		int exposures, const struct transfer_curve *curve, struct fault *fault);

#endif
