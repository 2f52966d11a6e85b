/* SPDX-License-Identifier: MIT */
/*
 * A view is a rectangle of a camera's picture, seen upright.
 *
 * A composer puts several cameras into one picture, mounts them upside down, and a digitizer
 * squashes them; all that is undone by where pixels are read from, never by moving them. Rotation
 * by 180 degrees is both flips.
 */
#ifndef INLAY_HAL_FRAME_VIEW_H
#define INLAY_HAL_FRAME_VIEW_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/base/fault.h"

struct view {
	int x, y, width,
		height; /* in the camera's pixels; width 0: to the right edge, height 0 alike */
	bool hflip, vflip;
	double squash; /* height of a camera pixel over its width, > 0; 2 where every other line was
			  lost. Only what is shown on a screen is stretched by it. */
};

/* An upright picture inside other memory: pixel (x, y) is at origin + x*x_step + y*y_step. */
struct picture {
	const uint8_t *origin;	  /* BGRX of the upright picture's upper left pixel */
	ptrdiff_t x_step, y_step; /* bytes, possibly negative */
	int width, height;
};

/* Replaces zero sizes and checks that the rectangle lies in a camera picture of this size. */
int view_resolve(struct view *view, int camera_width, int camera_height, struct fault *fault);

/* The view of a BGRX picture that starts at pixels with this stride. */
struct picture view_picture(const struct view *view, const uint8_t *pixels, size_t stride);

/* Upright view coordinates to camera coordinates and back; pixel centres lie at +0.5. */
void view_to_camera(const struct view *view, const double upright[2], double camera[2]);
void view_from_camera(const struct view *view, const double camera[2], double upright[2]);

#endif
