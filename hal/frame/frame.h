/* SPDX-License-Identifier: MIT */
/*
 * A picture as a camera delivers it, and a plain BGRX picture as the rest of the program reads it.
 */
#ifndef INLAY_HAL_FRAME_FRAME_H
#define INLAY_HAL_FRAME_FRAME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/base/fault.h"
#include "hal/colour/transfer.h"

/* Named by the order of bytes in memory. */
enum pixel_format {
	PIXEL_NONE,
	PIXEL_YUYV, /* 4:2:2 packed */
	PIXEL_UYVY, /* 4:2:2 packed */
	PIXEL_NV12, /* 4:2:0, planes Y and UV */
	PIXEL_RGB24,
	PIXEL_BGR24,
	PIXEL_BGRX, /* V4L2 XBGR32, DRM XRGB8888, libyuv ARGB: the working format */
	PIXEL_GREY,
	PIXEL_MJPEG, /* one JPEG picture; planes[0].bytes is its length */
	PIXEL_RGBF,  /* three float32 a pixel, linear radiance, unclipped (simulated cameras) */
	PIXEL_FORMAT_COUNT
};

extern const char *const pixel_format_names[]; /* "none", "YUYV", ... NULL */

enum colour_matrix { MATRIX_BT601, MATRIX_BT709, MATRIX_COUNT };
enum colour_range { RANGE_LIMITED, RANGE_FULL, RANGE_COUNT };

/* How the two fields of interlaced video lie in a frame. The top field holds lines 0, 2, ... */
enum frame_fields {
	FIELDS_NONE,	   /* progressive */
	FIELDS_INTERLACED, /* line by line */
	FIELDS_TOP_BOTTOM, /* one above the other, each at half the height */
	FIELDS_BOTTOM_TOP,
	FIELDS_PAIR, /* in memory of their own: planes is the top field, bottom_planes the other */
	FIELDS_TOP,  /* one alone; width and height are those of the whole picture */
	FIELDS_BOTTOM,
	FIELDS_COUNT
};

/* What becomes of the two fields. */
enum deinterlace {
	DEINTERLACE_WEAVE, /* both, line by line: sharp at rest, combed in motion; the default */
	DEINTERLACE_BOB, /* the later field alone, its lines interpolated: half the height's detail
			  */
	DEINTERLACE_BLEND, /* both, half of each in every line (1 2 1 down the lines): soft, never
			      combed */
	DEINTERLACE_COUNT
};

extern const char *const deinterlace_names[]; /* "weave", "bob", "blend", NULL */

#define FRAME_PLANES 3

struct frame_plane {
	const uint8_t *data;
	size_t stride; /* bytes from a row to the next; at least what a row needs */
	size_t bytes;  /* readable bytes from data; rows are checked against it */
};

struct frame {
	enum pixel_format format;
	int width, height; /* pixels, of the whole picture */
	struct frame_plane planes[FRAME_PLANES];
	enum frame_fields fields;
	bool bottom_first; /* the bottom field was captured before the top one */
	struct frame_plane bottom_planes[FRAME_PLANES]; /* of FIELDS_PAIR */
	enum colour_matrix matrix;			/* of Y'CbCr formats */
	enum colour_range
		range;	      /* of Y'CbCr and R'G'B' formats; for the latter mostly RANGE_FULL */
	int64_t timestamp_ns; /* of capture, CLOCK_MONOTONIC */
	uint32_t sequence;    /* counts at the source: a gap is a lost frame */
	int buffer;	      /* the driver's own handle; others leave it alone */
};

/* Frames of one source, counted by their sequence; zeroed, none has come. */
struct frame_count {
	bool begun;
	uint32_t last;
};

/* How many went missing before this one. Numbers wrap; a step back means that the source counts
 * anew. */
uint32_t frame_count_gap(struct frame_count *count, uint32_t sequence);

/* An owned BGRX picture (X is 255). */
struct canvas {
	int width, height;
	size_t stride; /* bytes; a multiple of 64 */
	uint8_t *pixels;
};

int canvas_create(struct canvas *canvas, int width, int height);
void canvas_free(struct canvas *canvas); /* idempotent */

/* How many bytes each plane of the format needs at this size and stride; 0 for an unknown format
 * or MJPEG. */
size_t frame_plane_bytes(enum pixel_format format, int plane, size_t stride, int height);
/* The smallest stride of a plane. */
size_t frame_plane_stride(enum pixel_format format, int plane, int width);

/* Whether a progressive frame's planes hold its picture; not of MJPEG. 0 or -EINVAL. */
int frame_check(const struct frame *frame, struct fault *fault);

#endif
