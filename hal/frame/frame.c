/* SPDX-License-Identifier: MIT */
#include "hal/frame/frame.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

const char *const deinterlace_names[] = {"weave", "bob", "blend", NULL};

_Static_assert(sizeof(deinterlace_names) / sizeof(deinterlace_names[0]) == DEINTERLACE_COUNT + 1,
	       "a name for each way to deinterlace");

const char *const pixel_format_names[] = {
	"none", "YUYV", "UYVY", "NV12", "RGB24", "BGR24", "BGRX", "GREY", "MJPEG", "RGBF", NULL,
};

_Static_assert(sizeof(pixel_format_names) / sizeof(pixel_format_names[0]) == PIXEL_FORMAT_COUNT + 1,
	       "a name for each format");

enum { CANVAS_ALIGNMENT = 64, CANVAS_SIDE_MAX = 32768 };

int canvas_create(struct canvas *canvas, int width, int height)
{
	size_t stride;

	memset(canvas, 0, sizeof(*canvas));
	if (width < 1 || height < 1 || width > CANVAS_SIDE_MAX || height > CANVAS_SIDE_MAX)
		return -EINVAL;
	stride = ((size_t)width * 4 + CANVAS_ALIGNMENT - 1) & ~(size_t)(CANVAS_ALIGNMENT - 1);
	canvas->pixels = aligned_alloc(CANVAS_ALIGNMENT, stride * (size_t)height);
	if (!canvas->pixels)
		return -ENOMEM;
	memset(canvas->pixels, 0, stride * (size_t)height);
	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++)
			canvas->pixels[(size_t)y * stride + (size_t)x * 4 + 3] = 255;
	canvas->width = width;
	canvas->height = height;
	canvas->stride = stride;
	return 0;
}

void canvas_free(struct canvas *canvas)
{
	free(canvas->pixels);
	memset(canvas, 0, sizeof(*canvas));
}

uint32_t frame_count_gap(struct frame_count *count, uint32_t sequence)
{
	const uint32_t step = sequence - count->last;
	const bool gap = count->begun && step > 1 && step < UINT32_MAX / 2;

	*count = (struct frame_count){true, sequence};
	return gap ? step - 1 : 0;
}

size_t frame_plane_stride(enum pixel_format format, int plane, int width)
{
	const size_t w = width > 0 ? (size_t)width : 0;
	const size_t pairs = (w + 1) / 2;

	if (plane < 0 || plane > (format == PIXEL_NV12 ? 1 : 0))
		return 0;
	switch (format) {
	case PIXEL_YUYV:
	case PIXEL_UYVY:
		return pairs * 4;
	case PIXEL_NV12:
		return plane == 0 ? w : pairs * 2;
	case PIXEL_RGB24:
	case PIXEL_BGR24:
		return w * 3;
	case PIXEL_BGRX:
		return w * 4;
	case PIXEL_GREY:
		return w;
	case PIXEL_RGBF:
		return w * 3 * sizeof(float);
	default:
		return 0;
	}
}

size_t frame_plane_bytes(enum pixel_format format, int plane, size_t stride, int height)
{
	size_t rows = height > 0 ? (size_t)height : 0;

	if (frame_plane_stride(format, plane, 1) == 0)
		return 0;
	if (format == PIXEL_NV12 && plane == 1)
		rows = (rows + 1) / 2;
	return stride * rows;
}

static int frame_check_plane(const struct frame *frame, int plane, struct fault *fault)
{
	const struct frame_plane *p = &frame->planes[plane];
	const size_t row = frame_plane_stride(frame->format, plane, frame->width);
	const size_t rows = frame_plane_bytes(frame->format, plane, 1, frame->height);

	if (!p->data || p->stride < row || p->stride > INT_MAX ||
	    p->bytes < p->stride * (rows - 1) + row)
		return fault_say(fault, -EINVAL,
				 "frame: plane %d of %s at %dx%d has stride %zu and %zu bytes, "
				 "expected a stride of at least %zu and %zu bytes",
				 plane, pixel_format_names[frame->format], frame->width,
				 frame->height, p->stride, p->bytes, row,
				 p->stride * (rows - 1) + row);
	return 0;
}

int frame_check(const struct frame *frame, struct fault *fault)
{
	const int planes = frame->format == PIXEL_NV12 ? 2 : 1;

	for (int i = 0; i < planes; i++) {
		int err = frame_check_plane(frame, i, fault);

		if (err)
			return err;
	}
	return 0;
}
