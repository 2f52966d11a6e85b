/* SPDX-License-Identifier: MIT */
/*
 * A camera's raw frame read as an upright BGRX picture, any part of it at a time, straight from the
 * memory that the camera filled: matrix, range, packing, flips and the view are undone on the way,
 * and no picture is made in between.
 *
 * Raw is what needs no more than its own row: progressive Y'CbCr, R'G'B' and grey. Compressed
 * frames, frames in two fields and float pictures are decoded whole (frame.h).
 *
 * Memory of some boards' cameras is not cached, so that reading it twice costs twice: each part
 * asked for is read once, row by row, from left to right in the camera's order (NV12's chroma rows
 * once for each of their two rows of pixels, pairs that a part cuts by both its neighbours).
 * Whole rows, each asked for once and in order, are the cheapest to read everywhere.
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

/* Whether a frame_reader can read such a frame. */
bool frame_is_raw(const struct frame *frame);

/* A resolved view of a frame, which stays the caller's and must stay in place. Nothing is allocated
 * and nothing is to be closed. -ENOTSUP: not raw; -EINVAL: short planes, a view beyond the frame.
 */
int frame_reader_open(struct frame_reader *reader, const struct frame *frame,
		      const struct view *view, struct fault *fault);

/* The same of a BGRX picture in memory. x_step is 4 or -4. */
struct frame_reader frame_reader_of(const struct picture *picture);

/*
 * Writes a part of the upright picture, BGRX with X = 255; out and its stride are multiples of four
 * bytes. context is a struct frame_reader: what struct backdrop (compositor.h) asks for. Several
 * threads may, at once.
 */
void frame_reader_make(const void *context, int x, int y, int width, int height, uint8_t *out,
		       size_t out_stride);

/* count pixels of one row: in the frame itself where they lie there as BGRX (X is anything), else
 * made in scratch. */
const uint32_t *frame_reader_row(const struct frame_reader *reader, int x, int y, int count,
				 uint32_t *scratch);

/* Asks for what a part of a row will be read from, so that it is in the cache by then. */
void frame_reader_prefetch(const struct frame_reader *reader, int x, int y, int count);

#endif
