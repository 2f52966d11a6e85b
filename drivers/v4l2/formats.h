/* SPDX-License-Identifier: MIT */
/* Translates V4L2's formats and colours to those of inlay. Pure: touches no device. */
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

/* Returns the layout of a format. NULL: inlay does not decode it. */
const struct v4l2_layout *v4l2_layout_of(uint32_t fourcc);

/* The same, as the wanted format if its bytes can be read as that too. */
const struct v4l2_layout *v4l2_layout_as(uint32_t fourcc, enum pixel_format wanted);

/* A format that a device offers. */
struct v4l2_offer {
	uint32_t fourcc;
	bool size; /* it has the wanted size, or none is wanted */
	bool rate; /* it has the wanted rate at that size, or none is wanted */
};

/* Returns the index of the offer of the greatest camera_format_merit() among those of the wanted
 * format (PIXEL_NONE: of any); -1: none. */
int v4l2_choose(const struct v4l2_offer *offers, int count, enum pixel_format wanted);

/* Reads the matrix and range that the driver declares; its defaults are resolved as the kernel's
 * documentation says. Matrices that inlay lacks (SMPTE 240M, BT.2020) become BT.709, the
 * nearest. */
void v4l2_colours(const struct v4l2_pix_format *format, enum colour_matrix *matrix,
		  enum colour_range *range);

/* A format as the driver set it, single- or multi-planar alike. */
struct v4l2_picture {
	const struct v4l2_layout *layout;
	int width, height; /* of the whole picture */
	int rows;	   /* in a buffer: height, or half of it when a buffer holds one field */
	struct v4l2_lines lines;
	v4l2_std_id standard;
	size_t stride[FRAME_PLANES]; /* bytes, of the frame's planes; 0 for JPEG and H.264 */
	enum colour_matrix matrix;
	enum colour_range range;
};

/* Reads a format that the driver returned, under this television standard (0: none). If a single
 * field has the height that was asked for the whole picture (wanted_height; 0: none), the picture
 * counts as progressive: the device has squeezed it. 0; -ENOTSUP: inlay does not decode the format;
 * -EINVAL: no size, a stride (0: not told) too small for the width, or a height that cannot be
 * split into fields. */
int v4l2_picture_of(const struct v4l2_format *format, v4l2_std_id standard, int wanted_height,
		    struct v4l2_picture *picture, struct fault *fault);

struct v4l2_span {
	const uint8_t *data;
	size_t bytes; /* that hold data */
};

/* Points the frame's planes into a buffer's memory (one or two planes). False: the buffer holds
 * too few bytes. */
bool v4l2_fill_planes(const struct v4l2_picture *picture, const struct v4l2_span memory[2],
		      struct frame_plane planes[FRAME_PLANES]);

/* Returns the bits of a pixel on the bus; for JPEG and H.264 an estimate. 0: inlay does not decode
 * it. */
int v4l2_bits(uint32_t fourcc);

/* Writes the four characters of a format, like "YUYV"; unprintable ones become dots. */
void v4l2_fourcc_text(uint32_t fourcc, char text[5]);

#endif
