/* SPDX-License-Identifier: MIT */
/* Where a simulated camera stands and what each of its pixels looks at. */
#ifndef INLAY_DRIVERS_SIM_EYE_H
#define INLAY_DRIVERS_SIM_EYE_H

#include <stdbool.h>

#include "hal/optics/fisheye.h"
#include "hal/optics/tsai.h"

struct sim_eye {
	int width, height;
	bool fisheye;
	struct fisheye lens;	   /* of a fisheye */
	double position[3];	   /* of a fisheye */
	struct tsai_camera camera; /* otherwise */
};

/* The ray of a point in the picture; dir is a unit vector. False when nothing is seen there. */
bool eye_ray(const struct sim_eye *eye, const double px[2], double origin[3], double dir[3]);

/* About how wide a pixel-sized patch is, rad: the mean of its two sides. 0 where nothing is
 * seen. */
double eye_pixel_rad(const struct sim_eye *eye, const double px[2]);

/* Whether the rim of a fisheye's image circle goes through a pixel, which then sees in part. */
bool eye_on_rim(const struct sim_eye *eye, int x, int y);

#endif
