/* SPDX-License-Identifier: MIT */
/*
 * Places the rim of an image circle to hundredths of a pixel, given an ellipse that is already
 * near.
 *
 * Light ends at the rim: outside it is dark; inside is whatever the surroundings are there. Each
 * piece of the rim is fitted by least squares, in linear light, with
 *     dark + (a + b u + c t + d u^2)   for u > 0
 *     dark                             for u < 0
 * where u is the distance inwards from the edge and t the distance along it. The model is averaged
 * over the squares of the pixels, after a blur that is the same all around and estimated too. A
 * skyline that grows brighter inwards is therefore not mistaken for the edge.
 */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_CIRCLE_FISHEYE_EDGE_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_CIRCLE_FISHEYE_EDGE_H

#include "bake/calibrate/fisheye/circle/fisheye_ellipse.h"
#include "bake/calibrate/fisheye/circle/fisheye_rim.h"

/*
 * Replaces the rim's edges by refined ones around the ellipse, at most reach_px from it, each with
 * its deviation from noise and misfit. Uncertain ones are left out. -ENOMEM.
 */
int edges_place(struct rim *rim, const double ellipse[ELLIPSE_NUMBERS], double reach_px);

#endif
