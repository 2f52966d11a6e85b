/* SPDX-License-Identifier: MIT */
/*
 * The two fields of an interlaced picture, each as a progressive picture of half the height, and
 * filters over their lines.
 */
#ifndef INLAY_HAL_FRAME_FRAME_FIELDS_H
#define INLAY_HAL_FRAME_FRAME_FIELDS_H

#include "hal/frame/frame.h"

/* Checks that the lines can be divided between two fields. 0; -EINVAL: an odd height, or NV12 in
 * one picture with an odd number of chroma lines. Not for FIELDS_NONE. */
int frame_fields_check(const struct frame *frame, struct fault *fault);

/* Whether the frame has this field; FIELDS_TOP and FIELDS_BOTTOM have one. */
bool frame_fields_has(const struct frame *frame, bool bottom);

/* One field as a progressive frame in the same memory. Its planes may be too short: the caller
 * checks. Not for MJPEG. */
struct frame frame_fields_one(const struct frame *frame, bool bottom);

/* Every other line of a canvas, as a canvas of half the height in the same memory; never free
 * it. */
struct canvas canvas_field(const struct canvas *canvas, bool bottom);

/* Fills the lines of the other field with the mean of their neighbours; a line at the edge repeats
 * its only neighbour. */
void canvas_interpolate(struct canvas *canvas, bool from_bottom);

/* Replaces each line by (above + 2 line + below) / 4, mirrored at the edges. At least two lines.
 * scratch: two rows. */
void canvas_blend(struct canvas *canvas, uint8_t *scratch);

#endif
