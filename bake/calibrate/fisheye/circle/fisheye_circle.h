/* SPDX-License-Identifier: MIT */
/* A fisheye lens from the image circle in one picture. The rim of the circle is at a known angle
 * from the axis (the thesis: 90 degrees), and its image is an ellipse, from which centre and focal
 * lengths follow. Model and orientation do not follow. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_CIRCLE_FISHEYE_CIRCLE_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_CIRCLE_FISHEYE_CIRCLE_H

#include "bake/calibrate/fisheye/fisheye_find.h"
#include "hal/image/image.h"

/*
 * Calibrates. seen receives the points of the rim and must outlive the result; model AUTO means
 * equidistant, and the field is at most rim_deg. Returns what fisheye_find() returns; -EINVAL: the
 * model has no image at that angle.
 */
int fisheye_circle(struct fisheye_result *result, struct observations *seen,
		   const struct image *picture, const char *name, double rim_deg,
		   const struct fisheye_wanted *wanted, struct fault *fault);

#endif
