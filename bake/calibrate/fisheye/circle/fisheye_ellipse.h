/* SPDX-License-Identifier: MIT */
/* An ellipse with level axes: the image of a fisheye's rim, because the digitizer squashes along
 * rows and columns. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_CIRCLE_FISHEYE_ELLIPSE_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_CIRCLE_FISHEYE_ELLIPSE_H

#include "bake/calibrate/estimate/least_squares.h"
#include "bake/calibrate/fisheye/circle/fisheye_rim.h"

#define ELLIPSE_FEWEST 24 /* fewest edges */

enum { ELLIPSE_CENTRE = 0, ELLIPSE_AXES = 2, ELLIPSE_NUMBERS = 4 };

/* Signed distance of px from the ellipse, > 0 outside: exact for circles, else to first order. */
double ellipse_distance(const double ellipse[ELLIPSE_NUMBERS], const double px[2]);

/* Outward unit normal at a point near the ellipse. */
void ellipse_normal(const double ellipse[ELLIPSE_NUMBERS], const double px[2], double normal[2]);

/* Angle of a point around the ellipse, 0..2 pi, on the circle that it is squashed from. */
double ellipse_turn(const double ellipse[ELLIPSE_NUMBERS], const double px[2]);

/* RANSAC: of ellipses fitted to six random edges each, finds the one that most edges lie on;
 * returns how many do. */
int ellipse_search(const struct rim *rim, double ellipse[ELLIPSE_NUMBERS]);

/* Least-squares fit to every step-th edge from first on, weighted by their deviations, from a first
 * guess. Residuals are in deviations. Returns what least_squares_solve() returns. */
int ellipse_fit(const struct rim *rim, int first, int step, double ellipse[ELLIPSE_NUMBERS],
		struct least_squares_fit *found, struct fault *fault);

/* The same for all edges, with a covariance that does not treat the errors of neighbouring edges as
 * independent: their causes, a skyline or glare, extend along the rim. */
int ellipse_known(const struct rim *rim, double ellipse[ELLIPSE_NUMBERS],
		  struct least_squares_fit *found, struct fault *fault);

#endif
