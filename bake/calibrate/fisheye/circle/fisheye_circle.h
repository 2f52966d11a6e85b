/* SPDX-License-Identifier: MIT */
/* A fisheye lens from the image circle in one picture: its rim is at a known angle from the axis
 * (the thesis: 90 degrees), so that centre and focal lengths follow from the ellipse it is. Model
 * and orientation do not. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_CIRCLE_FISHEYE_CIRCLE_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_CIRCLE_FISHEYE_CIRCLE_H

#include "bake/calibrate/fisheye/fisheye_find.h"
#include "hal/image/image.h"

/*
 * seen gets the points of the rim and is borrowed by the result; wanted's model AUTO stands for
 * equidistant, its field is at most rim_deg. As fisheye_find(). -EINVAL: that model has nothing at
 * that angle.
 */
int fisheye_circle(struct fisheye_result *result, struct observations *seen,
		   const struct image *picture, const char *name, double rim_deg,
		   const struct fisheye_wanted *wanted, struct fault *fault);

#endif
