/* SPDX-License-Identifier: MIT */
/*
 * Depths as a depth camera measures them: a frame of PIXEL_Z16, seen upright. A depth is the
 * distance along the camera's axis, not along the ray. No pixel is moved and none is averaged: the
 * mean of two depths at an edge is a place where nothing is.
 */
#ifndef INLAY_HAL_FRAME_DEPTH_H
#define INLAY_HAL_FRAME_DEPTH_H

#include "hal/frame/frame.h"
#include "hal/frame/view.h"

/* An upright picture of depths inside other memory: pixel (x, y) is the little-endian word of 16
 * bits at origin + x*x_step + y*y_step; 0: not known. */
struct depth_map {
	const uint8_t *origin;
	ptrdiff_t x_step, y_step; /* bytes, possibly negative */
	int width, height;
	double unit_m; /* what 1 in a word stands for */
};

/* The depths of a frame, which the caller keeps in place; view is resolved for the frame turned
 * upright. 0; -ENOTSUP: the frame has no depths; -EINVAL: short planes, a view beyond the frame. */
int depth_map_of(struct depth_map *map, const struct frame *frame, enum picture_turn turn,
		 const struct view *view, double unit_m, struct fault *fault);

/* The depth of a pixel in m; 0: not known. */
double depth_map_at(const struct depth_map *map, int x, int y);

#endif
