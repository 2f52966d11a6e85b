/* SPDX-License-Identifier: MIT */
/* An ellipse with level axes: what the rim of a fisheye's image circle is, since the digitizer
 * squashes along rows and columns. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_CIRCLE_FISHEYE_ELLIPSE_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_CIRCLE_FISHEYE_ELLIPSE_H

#include "bake/calibrate/estimate/least_squares.h"
#include "bake/calibrate/fisheye/circle/fisheye_rim.h"

#define ELLIPSE_FEWEST 24 /* edges */

enum { ELLIPSE_CENTRE = 0, ELLIPSE_AXES = 2, ELLIPSE_NUMBERS = 4 };

/* Distance from it, > 0 outside: exact for circles, else to first order. */
double ellipse_distance(const double ellipse[ELLIPSE_NUMBERS], const double px[2]);

/* The unit vector away from it at a point near to it. */
void ellipse_normal(const double ellipse[ELLIPSE_NUMBERS], const double px[2], double normal[2]);

/* Where a point lies around it: 0..2 pi, of the circle that it is squashed from. */
double ellipse_turn(const double ellipse[ELLIPSE_NUMBERS], const double px[2]);

/* The ellipse that most edges lie on, of those through a few of them; returns how many do. */
int ellipse_search(const struct rim *rim, double ellipse[ELLIPSE_NUMBERS]);

/* The one nearest to every step-th edge from first on, by their deviations, from a first guess.
 * Residuals are in deviations. As least_squares_solve(). */
int ellipse_fit(const struct rim *rim, int first, int step, double ellipse[ELLIPSE_NUMBERS],
		struct least_squares_fit *found, struct fault *fault);

/* The same of all edges, with a covariance that does not take neighbouring edges' errors for
 * independent: what they err by, a skyline and glare, goes on along the rim. */
int ellipse_known(const struct rim *rim, double ellipse[ELLIPSE_NUMBERS],
		  struct least_squares_fit *found, struct fault *fault);

#endif
