/* SPDX-License-Identifier: MIT */
/*
 * A fisheye lens as a vector of numbers, with the derivatives of its projection.
 * hal/optics/fisheye.h defines the numbers.
 */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_OPTICS_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_OPTICS_H

#include <stdbool.h>

#include "hal/optics/fisheye.h"

enum {
	OPTICS_FOCAL = 0, /* horizontal, vertical, px */
	OPTICS_CENTRE = 2,
	OPTICS_TERMS = 4, /* k1..k4 */
	OPTICS_COUNT = 8
};

struct optics {
	enum fisheye_model model;
	double number[OPTICS_COUNT];
};

extern const char *const optics_names[OPTICS_COUNT]; /* "focal x", ... */

struct fisheye_curve optics_curve(const struct optics *optics);

/*
 * Projects a point in camera axes. by_number[OPTICS_COUNT] and by_point[3] receive the derivatives
 * of px; both may be NULL. False: the model cannot show the point (behind the end of the axis,
 * beyond a fold), or the numbers are no lens.
 */
bool optics_project(const struct optics *optics, const double point[3], double px[2],
		    double (*by_number)[2], double (*by_point)[2]);

/* Back-projects px to a unit vector in camera axes, up to 180 degrees from the axis or to the
 * model's fold; false beyond. */
bool optics_ray(const struct optics *optics, const double px[2], double ray[3]);

#endif
