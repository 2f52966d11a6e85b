/* SPDX-License-Identifier: MIT */
/*
 * The edge spread of a simulated camera: linear light is convolved with the Gaussian of discrete
 * places (Lindeberg 1990), whose variance is sigma^2 at any sigma, cut off beyond four sigma:
 *
 *     w(n) = exp(-sigma^2) I_n(sigma^2)    I_n: modified Bessel function
 *
 * Pixels are means over their squares already, so that a straight edge becomes their box convolved
 * with the Gaussian, as `edge_spread` of a camera file means it (hal/optics/tsai.h). Beyond the
 * picture's border its outermost pixels go on.
 */
#ifndef INLAY_DRIVERS_SIM_SPREAD_H
#define INLAY_DRIVERS_SIM_SPREAD_H

#define SPREAD_MAX_PX 8.0

/* Blurs rgb[height][width][3] into to, through scratch; all three are of one size and none is
 * another. 0 < sigma_px <= SPREAD_MAX_PX. */
void spread_edges(const float *rgb, int width, int height, double sigma_px, float *scratch,
		  float *to);

#endif
