/* SPDX-License-Identifier: MIT */
/*
 * The two fields of an interlaced picture, each as a progressive one of half the height, and what
 * is made of their lines.
 */
#ifndef INLAY_HAL_FRAME_FRAME_FIELDS_H
#define INLAY_HAL_FRAME_FRAME_FIELDS_H

#include "hal/frame/frame.h"

/* -EINVAL: the lines cannot be told apart (an odd height, NV12 in one picture whose chroma lines
 * are odd in number). Not of FIELDS_NONE. */
int frame_fields_check(const struct frame *frame, struct fault *fault);

/* The frame has this field; FIELDS_TOP and FIELDS_BOTTOM have one. */
bool frame_fields_has(const struct frame *frame, bool bottom);

/* One field, in the frame's own memory. The planes may be too short: whoever reads them checks. Not
 * of MJPEG. */
struct frame frame_fields_one(const struct frame *frame, bool bottom);

/* Every other line of a canvas, as one of half the height; borrowed, never freed. */
struct canvas canvas_field(const struct canvas *canvas, bool bottom);

/* Fills the lines between those of one field with the mean of their neighbours; the outermost one
 * repeats its only neighbour. */
void canvas_interpolate(struct canvas *canvas, bool from_bottom);

/* Each line becomes a quarter, a half and a quarter of the line above, itself and the line below;
 * beyond the edges lies the line on the other side. At least two lines. scratch: two rows. */
void canvas_blend(struct canvas *canvas, uint8_t *scratch);

#endif
