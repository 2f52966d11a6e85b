/* SPDX-License-Identifier: MIT */
/*
 * A frame is a picture as a camera delivers it; a canvas is a BGRX picture as the rest of the
 * program reads it.
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
	PIXEL_YVYU, /* 4:2:2 packed */
	PIXEL_NV16, /* 4:2:2, planes Y and UV */
	PIXEL_NV12, /* 4:2:0, planes Y and UV */
	PIXEL_NV21, /* 4:2:0, planes Y and VU */
	PIXEL_YU12, /* 4:2:0, planes Y, U and V */
	PIXEL_YV12, /* 4:2:0, planes Y, V and U */
	PIXEL_P010, /* NV12 of 16-bit words, whose upper ten bits count */
	PIXEL_RGB24,
	PIXEL_BGR24,
	PIXEL_BGRX, /* V4L2 XBGR32, DRM XRGB8888, libyuv ARGB: the working format */
	PIXEL_GREY,
	PIXEL_Y10,   /* grey in the lower ten bits of 16 */
	PIXEL_Y12,   /* in the lower twelve */
	PIXEL_Y14,   /* in the lower fourteen */
	PIXEL_Y16,   /* grey of 16 bits; all words are little-endian */
	PIXEL_Z16,   /* depth of 16 bits (depth.h); read as grey, 8191 and more are white */
	PIXEL_MJPEG, /* one JPEG picture; planes[0].bytes is its length */
	PIXEL_H264,  /* what a camera sends; its driver decodes it, so that no frame has it */
	PIXEL_RGBF,  /* three float32 per pixel, linear radiance, unclipped (simulated cameras) */
	PIXEL_FORMAT_COUNT
};

extern const char *const pixel_format_names[]; /* "none", "YUYV", ... NULL */

enum colour_matrix { MATRIX_BT601, MATRIX_BT709, MATRIX_COUNT };
enum colour_range { RANGE_LIMITED, RANGE_FULL, RANGE_COUNT };

/* Layout of the two fields of interlaced video in a frame. The top field holds lines 0, 2, ... */
enum frame_fields {
	FIELDS_NONE,	   /* progressive */
	FIELDS_INTERLACED, /* line by line */
	FIELDS_TOP_BOTTOM, /* one above the other, each at half the height */
	FIELDS_BOTTOM_TOP,
	FIELDS_PAIR, /* in separate memory: planes is the top field, bottom_planes the bottom one */
	FIELDS_TOP,  /* one field alone; width and height are those of the whole picture */
	FIELDS_BOTTOM,
	FIELDS_COUNT
};

/* Ways to make one picture from two fields. */
enum deinterlace {
	DEINTERLACE_WEAVE, /* both fields, line by line: sharp at rest, combed in motion; default */
	DEINTERLACE_BOB,   /* the later field, missing lines interpolated: half the vertical detail
			    */
	DEINTERLACE_BLEND, /* both fields, filtered down the lines by (1 2 1) / 4: soft, never
			      combed */
	DEINTERLACE_COUNT
};

extern const char *const deinterlace_names[]; /* "weave", "bob", "blend", NULL */

/* How far a picture is turned clockwise: that of a camera that hangs on its side, to become
 * upright; or an upright one, for a screen that does. */
enum picture_turn {
	PICTURE_UPRIGHT,
	PICTURE_TURN_90,
	PICTURE_TURN_180,
	PICTURE_TURN_270,
	PICTURE_TURN_COUNT
};

extern const char *const picture_turn_names[]; /* "0", "90", "180", "270", NULL */

/* Whether width and height are exchanged. */
bool picture_turn_is_sideways(enum picture_turn turn);

#define FRAME_PLANES 3

struct frame_plane {
	const uint8_t *data;
	size_t stride; /* bytes from one row to the next, at least those of a row */
	size_t bytes;  /* readable bytes from data on; rows are checked against it */
};

struct frame {
	enum pixel_format format;
	int width, height; /* pixels, of the whole picture */
	struct frame_plane planes[FRAME_PLANES];
	enum frame_fields fields;
	bool bottom_first; /* the bottom field was captured before the top one */
	struct frame_plane bottom_planes[FRAME_PLANES]; /* FIELDS_PAIR only */
	enum colour_matrix matrix;			/* of Y'CbCr formats */
	enum colour_range
		range;	      /* of Y'CbCr and R'G'B' formats; for the latter mostly RANGE_FULL */
	int64_t timestamp_ns; /* time of capture, CLOCK_MONOTONIC */
	uint32_t sequence;    /* the source's count; a gap means lost frames */
	int buffer;	      /* private to the driver */
};

/* Counts the frames of one source by their sequence. Zeroed: no frame yet. */
struct frame_count {
	bool begun;
	uint32_t last;
};

/* Returns how many frames were lost before this one. The sequence may wrap; a step back means that
 * the source restarted its count, and loses none. */
uint32_t frame_count_gap(struct frame_count *count, uint32_t sequence);

/* A BGRX picture (X is 255) that owns its pixels. */
struct canvas {
	int width, height;
	size_t stride; /* bytes; a multiple of 64 */
	uint8_t *pixels;
};

/* Creates a black canvas. 0; -EINVAL: a side outside 1..32768; -ENOMEM. */
int canvas_create(struct canvas *canvas, int width, int height);
void canvas_free(struct canvas *canvas); /* idempotent */

/* Makes a canvas of this size of one that may have another; its content is lost then. 0 or as
 * canvas_create(). */
int canvas_fit(struct canvas *canvas, int width, int height);

/* Writes a picture turned, BGRX; to: of the turned size, stride in bytes. */
void canvas_turn(const struct canvas *canvas, enum picture_turn turn, uint8_t *to, size_t stride);

/* Number of planes; 1 for MJPEG. */
int frame_plane_count(enum pixel_format format);
/* Whether pixels are luma and chroma. Grey does not count. */
bool pixel_format_is_ycbcr(enum pixel_format format);
/* Whether two rows of pixels share a row of chroma. */
bool pixel_format_halves_rows(enum pixel_format format);
/* Bytes of a plane at this stride and picture height; 0 for MJPEG or an unknown format. */
size_t frame_plane_bytes(enum pixel_format format, int plane, size_t stride, int height);
/* Smallest stride of a plane at this picture width, in bytes; 0 as above. */
size_t frame_plane_stride(enum pixel_format format, int plane, int width);

/* Checks that the planes of a progressive frame hold its picture. Not for MJPEG. 0 or -EINVAL. */
int frame_check(const struct frame *frame, struct fault *fault);

#endif
