/* SPDX-License-Identifier: MIT */
#include "hal/frame/frame.h"

#include <errno.h>
#include <libyuv.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

const char *const picture_turn_names[] = {"0", "90", "180", "270", NULL};

const char *const deinterlace_names[] = {"weave", "bob", "blend", NULL};

_Static_assert(sizeof(deinterlace_names) / sizeof(deinterlace_names[0]) == DEINTERLACE_COUNT + 1,
	       "a name for each way to deinterlace");

const char *const pixel_format_names[] = {
	"none", "YUYV", "UYVY",	 "YVYU",  "NV16", "NV12", "NV21", "YU12",
	"YV12", "P010", "RGB24", "BGR24", "BGRX", "GREY", "Y10",  "Y12",
	"Y14",	"Y16",	"Z16",	 "MJPEG", "H264", "RGBF", NULL,
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

int canvas_fit(struct canvas *canvas, int width, int height)
{
	if (canvas->width == width && canvas->height == height)
		return 0;
	canvas_free(canvas);
	return canvas_create(canvas, width, height);
}

bool picture_turn_is_sideways(enum picture_turn turn)
{
	return turn == PICTURE_TURN_90 || turn == PICTURE_TURN_270;
}

void canvas_turn(const struct canvas *canvas, enum picture_turn turn, uint8_t *to, size_t stride)
{
	static const enum RotationMode modes[] = {kRotate0, kRotate90, kRotate180, kRotate270};

	ARGBRotate(canvas->pixels, (int)canvas->stride, to, (int)stride, canvas->width,
		   canvas->height, modes[turn]);
}

uint32_t frame_count_gap(struct frame_count *count, uint32_t sequence)
{
	const uint32_t step = sequence - count->last;
	const bool gap = count->begun && step > 1 && step < UINT32_MAX / 2;

	*count = (struct frame_count){true, sequence};
	return gap ? step - 1 : 0;
}

/* Bytes of each plane for one pixel, and for a pair of pixels with common chroma. */
struct plane_layout {
	uint8_t pixel, pair;
	bool halved; /* a row for two rows of pixels */
};

static const struct plane_layout layouts[PIXEL_FORMAT_COUNT][FRAME_PLANES] = {
	[PIXEL_YUYV] = {{.pair = 4}},
	[PIXEL_UYVY] = {{.pair = 4}},
	[PIXEL_YVYU] = {{.pair = 4}},
	[PIXEL_NV16] = {{.pixel = 1}, {.pair = 2}},
	[PIXEL_NV12] = {{.pixel = 1}, {.pair = 2, .halved = true}},
	[PIXEL_NV21] = {{.pixel = 1}, {.pair = 2, .halved = true}},
	[PIXEL_YU12] = {{.pixel = 1}, {.pair = 1, .halved = true}, {.pair = 1, .halved = true}},
	[PIXEL_YV12] = {{.pixel = 1}, {.pair = 1, .halved = true}, {.pair = 1, .halved = true}},
	[PIXEL_P010] = {{.pixel = 2}, {.pair = 4, .halved = true}},
	[PIXEL_RGB24] = {{.pixel = 3}},
	[PIXEL_BGR24] = {{.pixel = 3}},
	[PIXEL_BGRX] = {{.pixel = 4}},
	[PIXEL_GREY] = {{.pixel = 1}},
	[PIXEL_Y10] = {{.pixel = 2}},
	[PIXEL_Y12] = {{.pixel = 2}},
	[PIXEL_Y14] = {{.pixel = 2}},
	[PIXEL_Y16] = {{.pixel = 2}},
	[PIXEL_Z16] = {{.pixel = 2}},
	[PIXEL_RGBF] = {{.pixel = 3 * sizeof(float)}},
};

int frame_plane_count(enum pixel_format format)
{
	int planes = 1;

	while (planes < FRAME_PLANES && layouts[format][planes].pair)
		planes++;
	return planes;
}

bool pixel_format_is_ycbcr(enum pixel_format format)
{
	return layouts[format][0].pair || layouts[format][1].pair;
}

bool pixel_format_halves_rows(enum pixel_format format)
{
	return layouts[format][1].halved;
}

size_t frame_plane_stride(enum pixel_format format, int plane, int width)
{
	const size_t w = width > 0 ? (size_t)width : 0;
	const struct plane_layout *layout;

	if (plane < 0 || plane >= FRAME_PLANES || (int)format < 0 || format >= PIXEL_FORMAT_COUNT)
		return 0;
	layout = &layouts[format][plane];
	return layout->pixel * w + layout->pair * ((w + 1) / 2);
}

size_t frame_plane_bytes(enum pixel_format format, int plane, size_t stride, int height)
{
	size_t rows = height > 0 ? (size_t)height : 0;

	if (frame_plane_stride(format, plane, 1) == 0)
		return 0;
	if (layouts[format][plane].halved)
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
		return fault_say(
			fault, -EINVAL,
			"frame: plane %d of %s at %dx%d has stride %zu and %zu bytes, expected a stride of at least %zu and %zu bytes",
			plane, pixel_format_names[frame->format], frame->width, frame->height,
			p->stride, p->bytes, row, p->stride * (rows - 1) + row);
	return 0;
}

int frame_check(const struct frame *frame, struct fault *fault)
{
	for (int i = 0; i < frame_plane_count(frame->format); i++) {
		int err = frame_check_plane(frame, i, fault);

		if (err)
			return err;
	}
	return 0;
}
