/* SPDX-License-Identifier: MIT */
/* Points of boards and lamps as a known fisheye sees them, for the tests of its calibration. */
#ifndef INLAY_TESTS_SUPPORT_CALIBRATE_FISHEYE_VIEWS_H
#define INLAY_TESTS_SUPPORT_CALIBRATE_FISHEYE_VIEWS_H

#include "bake/calibrate/observe/observations.h"
#include "hal/optics/fisheye.h"
#include "tests/support/chance.h"

/* A lens of each model, for 640 x 480: pixels not square, centre off the middle, tilted. */
extern const struct fisheye_settings fisheye_views_lenses[FISHEYE_MODEL_COUNT];

/* No view yet, 640 x 480. The caller frees with observations_free(). */
void fisheye_views_begin(struct observations *all);

/*
 * Adds a view of a board of 6 x 5 corners, 50 mm apart. Its middle lies 0.2 to 0.3 m from the
 * camera in the direction (theta, phi) from the axis, in rad; it faces the camera, tilted at
 * random. bend: standard deviation of its three second derivatives by 2, 1/m; 0: it is flat.
 */
void fisheye_see_board(struct observations *all, const struct fisheye *lens, double theta,
		       double phi, double bend, double sigma, struct chance *c);

/* Adds `count` boards: the first near the axis, the others all around it, up to theta. */
void fisheye_see_boards(struct observations *all, const struct fisheye *lens, int count,
			double theta, double sigma, struct chance *c);

#endif
