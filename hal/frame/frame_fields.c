/* SPDX-License-Identifier: MIT */
#include "hal/frame/frame_decode.h"

#include <errno.h>
#include <libyuv.h>
#include <string.h>

static bool shares_planes(const struct frame *frame)
{
	return frame->fields == FIELDS_INTERLACED || frame->fields == FIELDS_TOP_BOTTOM ||
	       frame->fields == FIELDS_BOTTOM_TOP;
}

int frame_fields_check(const struct frame *frame, struct fault *fault)
{
	if (frame->height % 2)
		return fault_say(fault, -EINVAL,
				 "frame: two fields in %d lines, expected an even number",
				 frame->height);
	if (pixel_format_halves_rows(frame->format) && shares_planes(frame) && frame->height % 4)
		return fault_say(fault, -EINVAL,
				 "frame: two fields of %s in %d lines, expected a multiple of 4",
				 pixel_format_names[frame->format], frame->height);
	return 0;
}

bool frame_fields_has(const struct frame *frame, bool bottom)
{
	return frame->fields != (bottom ? FIELDS_TOP : FIELDS_BOTTOM);
}

static struct frame_plane plane_every_other_row(const struct frame_plane *plane, bool bottom)
{
	const size_t skipped = bottom ? plane->stride : 0;

	if (!plane->data || plane->bytes < skipped)
		return (struct frame_plane){NULL, 0, 0};
	return (struct frame_plane){plane->data + skipped, plane->stride * 2,
				    plane->bytes - skipped};
}

static struct frame_plane plane_half(const struct frame_plane *plane, size_t rows, bool second)
{
	const size_t first = plane->stride * rows;

	if (!second)
		return *plane;
	if (!plane->data || plane->bytes < first)
		return (struct frame_plane){NULL, 0, 0};
	return (struct frame_plane){plane->data + first, plane->stride, plane->bytes - first};
}

struct frame frame_fields_one(const struct frame *frame, bool bottom)
{
	struct frame field = *frame;

	field.fields = FIELDS_NONE;
	field.height = frame->height / 2;
	for (int p = 0; p < frame_plane_count(frame->format); p++) {
		const struct frame_plane *plane = &frame->planes[p];
		const size_t rows = frame_plane_bytes(frame->format, p, 1, field.height);

		if (frame->fields == FIELDS_INTERLACED)
			field.planes[p] = plane_every_other_row(plane, bottom);
		else if (frame->fields == FIELDS_TOP_BOTTOM)
			field.planes[p] = plane_half(plane, rows, bottom);
		else if (frame->fields == FIELDS_BOTTOM_TOP)
			field.planes[p] = plane_half(plane, rows, !bottom);
		else if (frame->fields == FIELDS_PAIR && bottom)
			field.planes[p] = frame->bottom_planes[p];
	}
	return field;
}

struct canvas canvas_field(const struct canvas *canvas, bool bottom)
{
	return (struct canvas){
		.width = canvas->width,
		.height = canvas->height / 2,
		.stride = canvas->stride * 2,
		.pixels = canvas->pixels + (bottom ? canvas->stride : 0),
	};
}

static uint8_t *canvas_row(const struct canvas *canvas, int y)
{
	return canvas->pixels + (size_t)y * canvas->stride;
}

void canvas_interpolate(struct canvas *canvas, bool from_bottom)
{
	const int stride = (int)canvas->stride, last = canvas->height - 1;
	const int known = from_bottom ? 1 : 0;
	const int edge = from_bottom ? 0 : last, beside = from_bottom ? 1 : last - 1;

	/* libyuv's interpolation by 128 / 256 is (a + b + 1) >> 1. */
	if (last > 1)
		ARGBInterpolate(canvas_row(canvas, known), stride * 2,
				canvas_row(canvas, known + 2), stride * 2,
				canvas_row(canvas, known + 1), stride * 2, canvas->width, last / 2,
				128);
	memcpy(canvas_row(canvas, edge), canvas_row(canvas, beside), (size_t)canvas->width * 4);
}

static void blend_row(const uint8_t *restrict above, const uint8_t *restrict here,
		      const uint8_t *restrict below, size_t bytes, uint8_t *restrict to)
{
	for (size_t i = 0; i < bytes; i++)
		to[i] = (uint8_t)((above[i] + 2 * here[i] + below[i] + 2) >> 2);
}

void canvas_blend(struct canvas *canvas, uint8_t *scratch)
{
	const size_t bytes = (size_t)canvas->width * 4;
	uint8_t *above = scratch, *here = scratch + bytes;

	memcpy(above, canvas_row(canvas, 1), bytes);
	for (int y = 0; y < canvas->height; y++) {
		uint8_t *spare = above;
		bool last = y == canvas->height - 1;

		memcpy(here, canvas_row(canvas, y), bytes);
		blend_row(above, here, last ? above : canvas_row(canvas, y + 1), bytes,
			  canvas_row(canvas, y));
		above = here;
		here = spare;
	}
}
