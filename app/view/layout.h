/* SPDX-License-Identifier: MIT */
/* Where pictures go on the screen, and how they are scaled to go there. */
#ifndef INLAY_APP_VIEW_LAYOUT_H
#define INLAY_APP_VIEW_LAYOUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "config/config.h"
#include "hal/base/pool.h"
#include "hal/device/display.h"
#include "hal/frame/view.h"

/*
 * Scales a picture to another size by a tent filter: as wide as a source pixel where it enlarges
 * (bilinear), as a destination pixel where it shrinks, so that small things neither flicker nor
 * vanish. Weights are made once for a pair of sizes; equal sizes are an exact copy. (libyuv's
 * scaler allocates rows at every call, which the frame path must not.)
 */

struct scaler_axis {
	int from, to;
	int taps;	  /* source pixels under the filter of a destination pixel */
	int *first;	  /* [to]: its first source pixel; first + taps <= from */
	uint16_t *weight; /* [to][taps]: Q14, summing to 1 */
};

struct scaler {
	struct scaler_axis across, down;
	int workers;
	size_t scratch_bytes;
	uint8_t *scratch; /* [workers][scratch_bytes]: rows scaled across */
};

/* Prepares for these sizes, all at least 1; does nothing if it is prepared for them. 0 or -ENOMEM.
 * A zeroed scaler is valid. */
int scaler_fit(struct scaler *scaler, int from_width, int from_height, int to_width, int to_height,
	       const struct pool *pool);

/* Writes columns left..right-1 of the result, BGRX, each pixel once. out: where column left of the
 * first row goes. from has the size given to scaler_fit(); 0 <= left <= right <= to_width. */
void scaler_run(struct scaler *scaler, struct pool *pool, const struct picture *from, int left,
		int right, uint8_t *out, size_t out_stride);

void scaler_free(struct scaler *scaler); /* idempotent */

/* Copies an upright picture, pixel by pixel. */
void picture_copy(const struct picture *from, uint8_t *out, size_t out_stride);

/*
 * Where pictures go on the screen. A cell is a rectangle of the screen. Whoever places a picture in
 * a cell writes each pixel of the cell once, in order: the picture, and black around it.
 */

struct layout_box {
	int x, y, width, height;
};

/* Columns from..to-1 of the screen. */
struct layout_span {
	int from, to;
};

/* The whole screen; its halves, 0 and 1, beside each other or, where it is higher than wide, one
 * above the other; its quarters: 0 up left, 1 up right, 2 down left, 3 down right. */
struct layout_box layout_whole(const struct display_buffer *screen);
struct layout_box layout_half(const struct display_buffer *screen, int half);
struct layout_box layout_quarter(const struct display_buffer *screen, int quarter);

/* Where a picture of this size lies: in the middle of the cell, beyond its edges where the picture
 * is larger and not scaled. squash: height of a pixel over its width. */
struct layout_box layout_box(const struct layout_box *cell, int width, int height, double squash,
			     enum config_scale scale);

/* Whether the picture lies there pixel by pixel and uncut, so that it can be made in place. */
bool layout_in_place(const struct layout_box *cell, const struct layout_box *box, int width,
		     int height);

void layout_black(const struct display_buffer *screen, const struct layout_box *box);

/* Black in the cell around the box. */
void layout_border(const struct display_buffer *screen, const struct layout_box *cell,
		   const struct layout_box *box);

/* Draws columns of a picture that lies in the box, as far as they are in the cell, and no other
 * pixel. scaler keeps its tables for the next picture in the same place. 0 or -ENOMEM. */
int layout_fill(const struct display_buffer *screen, const struct layout_box *cell,
		const struct layout_box *box, const struct layout_span *columns,
		const struct picture *picture, struct scaler *scaler, struct pool *pool);

/* Draws a whole picture and its border. 0 or -ENOMEM. */
int layout_place(const struct display_buffer *screen, const struct layout_box *cell,
		 const struct picture *picture, double squash, enum config_scale scale,
		 struct scaler *scaler, struct pool *pool);

/* Columns of the line between two halves of a picture, always within the visible part of the box;
 * split: its place in it, 0..1. The line is white between black edges, to be seen on every
 * picture. */
struct layout_span layout_line(const struct layout_box *cell, const struct layout_box *box,
			       double split);
void layout_draw_line(const struct display_buffer *screen, const struct layout_box *cell,
		      const struct layout_box *box, const struct layout_span *line);

#endif
