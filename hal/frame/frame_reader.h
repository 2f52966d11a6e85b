/* SPDX-License-Identifier: MIT */
/*
 * Reads any part of a camera's raw frame as an upright BGRX picture, straight from the memory that
 * the camera filled. It applies matrix, range, unpacking, flips and view on the way and makes no
 * picture in between.
 *
 * A raw frame is one in which each row can be decoded by itself: progressive Y'CbCr, R'G'B' and
 * grey. Compressed frames, frames in fields and float pictures are decoded whole (frame_decode.h).
 *
 * On some boards the camera's memory is not cached, so each read costs. A part is read once, row by
 * row, from left to right in the camera's order (a chroma row of NV12 once for each of its two rows
 * of pixels; a chroma pair that two parts share once for each). It is cheapest everywhere to ask
 * for whole rows, each once and in order.
 */
#ifndef INLAY_HAL_FRAME_FRAME_READER_H
#define INLAY_HAL_FRAME_FRAME_READER_H

#include "hal/frame/frame.h"
#include "hal/frame/frame_rows.h"
#include "hal/frame/view.h"

struct frame_reader {
	struct frame frame; /* planes borrowed */
	struct view view;
	struct ycbcr ycbcr;
	const struct frame_rows *rows;
};

/* Whether a frame_reader can read the frame. */
bool frame_is_raw(const struct frame *frame);

/* Prepares to read a resolved view (view_resolve()) of a frame. The caller owns the frame's memory
 * and keeps it in place. Allocates nothing; there is no close. 0; -ENOTSUP: not raw; -EINVAL: short
 * planes, a view beyond the frame. */
int frame_reader_open(struct frame_reader *reader, const struct frame *frame,
		      const struct view *view, struct fault *fault);

/* A reader of a BGRX picture in memory, whose x_step is 4 or -4. */
struct frame_reader frame_reader_of(const struct picture *picture);

/*
 * Writes a part of the upright picture, BGRX with X = 255; out and its stride are multiples of four
 * bytes. context is a struct frame_reader; the signature is that of struct backdrop
 * (compositor.h). Several threads may call it at once.
 */
void frame_reader_make(const void *context, int x, int y, int width, int height, uint8_t *out,
		       size_t out_stride);

/* Returns count pixels of one row: a pointer into the frame if they lie there as upright BGRX (X is
 * undefined), else scratch, filled with them. */
const uint32_t *frame_reader_row(const struct frame_reader *reader, int x, int y, int count,
				 uint32_t *scratch);

/* Prefetches the memory that a part of a row will be read from. */
void frame_reader_prefetch(const struct frame_reader *reader, int x, int y, int count);

#endif
