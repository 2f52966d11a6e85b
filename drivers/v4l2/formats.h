/* SPDX-License-Identifier: MIT */
/* What V4L2 calls pictures and colours, and what we make of it. Nothing here touches a device. */
#ifndef INLAY_DRIVERS_V4L2_FORMATS_H
#define INLAY_DRIVERS_V4L2_FORMATS_H

#include <linux/videodev2.h>
#include <stdbool.h>
#include <stddef.h>

#include "drivers/v4l2/fields.h"
#include "hal/frame/frame.h"

struct v4l2_layout {
	uint32_t fourcc;
	enum pixel_format format;
	int memory_planes; /* separate buffers for one picture */
};

/* NULL: not one of ours. */
const struct v4l2_layout *v4l2_layout_of(uint32_t fourcc);

/* A format that a device enumerates. */
struct v4l2_offer {
	uint32_t fourcc;
	bool size; /* it has the wanted size, or none is wanted */
	bool rate; /* and at that size the wanted rate, or none is wanted */
};

/*
 * The offer to take, or -1: of the wanted format, if it is offered; for PIXEL_NONE of any; the one
 * of the greatest camera_format_merit().
 */
int v4l2_choose(const struct v4l2_offer *offers, int count, enum pixel_format wanted);

/* Matrix and range that the driver declares, its defaults resolved as the kernel's documentation
 * says. Matrices that we do not have (SMPTE 240M, BT.2020) become BT.709, the nearest. */
void v4l2_colours(const struct v4l2_pix_format *format, enum colour_matrix *matrix,
		  enum colour_range *range);

/* The most common fields of both kinds of struct v4l2_format. */
struct v4l2_picture {
	const struct v4l2_layout *layout;
	int width, height; /* of the whole picture */
	int rows;	   /* in a buffer: height, or half of it when a buffer holds one field */
	struct v4l2_lines lines;
	v4l2_std_id standard;
	size_t stride[2]; /* of our planes; 0 for JPEG */
	enum colour_matrix matrix;
	enum colour_range range;
};

/* Reads a format that the driver returned, under this television standard (0: none). A field alone
 * that is as high as the whole picture was asked to be (wanted_height; 0: not asked) is a
 * progressive picture: the device squeezed it. -ENOTSUP: not one of ours; -EINVAL: a stride too
 * small for the width, no size, or fields in a height that has no halves. */
int v4l2_picture_of(const struct v4l2_format *format, v4l2_std_id standard, int wanted_height,
		    struct v4l2_picture *picture, struct fault *fault);

struct v4l2_span {
	const uint8_t *data;
	size_t bytes; /* used */
};

/* Points the frame's planes into a buffer's memory (one or two planes). False when the buffer holds
 * less than it should: too few bytes, or JPEG that does not begin or end as JPEG does. What follows
 * the end of a JPEG picture is left out. */
bool v4l2_fill_planes(const struct v4l2_picture *picture, const struct v4l2_span memory[2],
		      struct frame_plane planes[FRAME_PLANES]);

/* Bits of a pixel on the way from the camera; of JPEG a guess. 0: not one of ours. */
int v4l2_bits(uint32_t fourcc);

/* "YUYV" and the like; bytes that are no letters show as dots. */
void v4l2_fourcc_text(uint32_t fourcc, char text[5]);

#endif
