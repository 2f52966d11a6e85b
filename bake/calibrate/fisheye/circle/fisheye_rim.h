/* SPDX-License-Identifier: MIT */
/* Finds where the bright image circle of a fisheye ends in a picture: points of its rim, to
 * fractions of a pixel. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_CIRCLE_FISHEYE_RIM_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_CIRCLE_FISHEYE_RIM_H

#include <stdbool.h>

#include "bake/calibrate/estimate/least_squares.h"
#include "hal/image/image.h"

struct rim_edge {
	double px[2];
	bool clipped; /* the light inside is clipped */
};

struct rim {
	struct rim_edge *edge; /* in order around the middle */
	int count;
	int rays; /* number of directions searched */
	int cut;  /* directions that are still bright where the picture ends */
};

/*
 * Searches inwards along rays to a point inside of the circle (NULL: the middle of the bright
 * part). An edge is where the picture first stays brighter than its dark surroundings, and there
 * where linear light falls most steeply (8-bit pictures are decoded as sRGB). count is 0 where
 * nothing stands out. -ENOMEM.
 */
int rim_find(struct rim *rim, const struct image *picture, const double middle[2]);
void rim_free(struct rim *rim); /* idempotent; zeroed is fine */

/* ---- the ellipse that the rim is: its axes are level, as the digitizer squashes along rows and
 * columns ---- */

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

/* Least-squares fit to the edges, from a first guess, with a covariance that does not treat the
 * errors of neighbouring edges as independent: their causes, a skyline or glare, extend along the
 * rim. Residuals are distances, px. Returns what least_squares_solve() returns. */
int ellipse_known(const struct rim *rim, double ellipse[ELLIPSE_NUMBERS],
		  struct least_squares_fit *found, struct fault *fault);

#endif
