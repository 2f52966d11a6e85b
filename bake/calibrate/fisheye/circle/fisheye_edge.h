/* SPDX-License-Identifier: MIT */
/*
 * The rim of an image circle to hundredths of a pixel, where an ellipse is already near to it.
 *
 * Light ends at the rim: outside it is dark, inside it is whatever the surroundings are there. So
 * every piece of the rim is fitted, in linear light and by least squares, with
 *     dark + (a + b u + c t + d u^2) where u > 0, dark where u < 0,
 * u the distance inwards from the edge and t along it, as pixels see it: averaged over their
 * squares, after a blur that is the same all around and found with it. A skyline that grows
 * brighter inwards is then no edge.
 */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_CIRCLE_FISHEYE_EDGE_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_CIRCLE_FISHEYE_EDGE_H

#include "bake/calibrate/fisheye/circle/fisheye_ellipse.h"
#include "bake/calibrate/fisheye/circle/fisheye_rim.h"

/*
 * Edges anew, around the ellipse, none farther from it than reach_px, each with its deviation: that
 * of noise and of what the model does not fit. Those that tell nothing are left out. -ENOMEM.
 */
int edges_place(struct rim *rim, const double ellipse[ELLIPSE_NUMBERS], double reach_px);

#endif
