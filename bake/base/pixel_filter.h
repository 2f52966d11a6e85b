/* SPDX-License-Identifier: MIT */
/*
 * Where the samples of a pixel lie. A pixel of a camera with edge spread sigma sees light weighted
 * by its square convolved with a Gaussian, along each axis with z(v) = v Phi(v / s) + s phi(v / s)
 *
 *     share of the weight below t:    F(t) = z(t) - z(t - 1)
 *
 * so a sample u of 0..1 goes to F^-1(u), and sobol_point()'s nets keep their strata. Samples all
 * weigh the same: the bake costs what it did, and the filter nothing at run time.
 */
#ifndef INLAY_BAKE_BASE_PIXEL_FILTER_H
#define INLAY_BAKE_BASE_PIXEL_FILTER_H

/* F^-1(unit): from the pixel's left or upper edge, in pixels. sigma_px 0: unit itself. */
double pixel_filter_place(double sigma_px, double unit);

#endif
