/* SPDX-License-Identifier: MIT */
/* The position and projection of a simulated camera: the ray of each pixel. */
#ifndef INLAY_DRIVERS_SIM_EYE_H
#define INLAY_DRIVERS_SIM_EYE_H

#include <stdbool.h>

#include "hal/optics/fisheye.h"
#include "hal/optics/tsai.h"

struct sim_eye {
	int width, height;
	bool fisheye;
	struct fisheye lens;	   /* if fisheye */
	double position[3];	   /* if fisheye; m */
	struct tsai_camera camera; /* if not fisheye */
};

/* Computes the ray of a point in the picture; dir is a unit vector. False: the point lies outside
 * the field of view. */
bool eye_ray(const struct sim_eye *eye, const double px[2], double origin[3], double dir[3]);

/* Returns the approximate angular width of a pixel at a point, in rad: the mean of its two sides. 0
 * outside the field of view. */
double eye_pixel_rad(const struct sim_eye *eye, const double px[2]);

/* Whether the rim of a fisheye's image circle crosses a pixel, part of which then sees nothing. */
bool eye_on_rim(const struct sim_eye *eye, int x, int y);

/* The ray of a pixel's middle of a camera that is no fisheye; returns how much farther along the
 * camera's axis it is for each metre along the ray, 0: there is no ray. */
double eye_along_axis(const struct sim_eye *eye, int x, int y, double origin[3], double dir[3]);

#endif
