/* SPDX-License-Identifier: MIT */
/*
 * A view is a rectangle of a camera's picture, seen upright.
 *
 * A video composer may show several cameras in one picture, a camera may hang upside down, and a
 * digitizer may squash the picture. The view changes only the places that pixels are read from; no
 * pixel is moved. Both flips make a rotation by 180 degrees.
 */
#ifndef INLAY_HAL_FRAME_VIEW_H
#define INLAY_HAL_FRAME_VIEW_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/base/fault.h"

struct view {
	int x, y, width,
		height; /* camera pixels; width 0: to the right edge; height 0: to the lower edge */
	bool hflip, vflip;
	double squash; /* height of a camera pixel / its width, > 0; 2 if every other line was lost.
			  Stretches the picture only on a screen. */
};

/* An upright picture inside other memory: pixel (x, y) is at origin + x*x_step + y*y_step. */
struct picture {
	const uint8_t *origin;	  /* BGRX of the upright picture's upper left pixel */
	ptrdiff_t x_step, y_step; /* bytes, possibly negative */
	int width, height;
};

/* Replaces zero sizes, and checks that the rectangle lies in a camera picture of this size. 0 or
 * -EINVAL; the view is unchanged then. */
int view_resolve(struct view *view, int camera_width, int camera_height, struct fault *fault);

/* The view of a BGRX picture that starts at pixels and has this stride in bytes. */
struct picture view_picture(const struct view *view, const uint8_t *pixels, size_t stride);

#endif
