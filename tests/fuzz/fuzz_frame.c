/* SPDX-License-Identifier: MIT */
/*
 * Any bytes as a camera's raw frame of any format, size, stride and order of fields, whose planes
 * may be too short: refused in a sentence, or a whole picture, read at once and in parts. Eleven
 * bytes say what it is, the others are its planes, in memory of exactly their length.
 *
 * reaches: frame_decode.c:frame_decode frame_reader.c:frame_reader_make
 * frame_fields.c:canvas_interpolate frame_fields.c:canvas_blend frame_reader.c:frame_reader_open
 * view.c:view_resolve
 */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "hal/frame/frame_decode.h"
#include "hal/frame/frame_reader.h"

enum { HEAD = 11, PLANES = 2 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

static uint8_t *exactly(const uint8_t *data, size_t bytes)
{
	uint8_t *copy = malloc(bytes ? bytes : 1);

	if (!copy)
		abort();
	if (bytes)
		memcpy(copy, data, bytes);
	return copy;
}

/* Divides the bytes: each plane gets what it needs, or the rest. */
static void fuzz_frame_fill(struct frame_plane *plane, const struct frame *frame, int height,
			    int more, const uint8_t **data, size_t *bytes)
{
	for (int k = 0; k < PLANES; k++) {
		size_t most;

		plane[k].stride = frame_plane_stride(frame->format, k, frame->width) + (size_t)more;
		most = frame_plane_bytes(frame->format, k, plane[k].stride, height);
		plane[k].bytes = most < *bytes ? most : *bytes;
		plane[k].data = exactly(*data, plane[k].bytes);
		*data += plane[k].bytes;
		*bytes -= plane[k].bytes;
	}
}

static void check_opaque(const struct canvas *canvas)
{
	for (int y = 0; y < canvas->height; y++)
		for (int x = 0; x < canvas->width; x++)
			if (canvas->pixels[(size_t)y * canvas->stride + (size_t)x * 4 + 3] != 255)
				abort();
}

static void decode(const struct frame *frame, enum deinterlace deinterlace)
{
	struct frame_decoder *decoder;
	struct fault fault = {""};
	struct canvas canvas;
	int err;

	if (frame_decoder_create(&decoder, deinterlace, PICTURE_UPRIGHT) ||
	    canvas_create(&canvas, frame->width, frame->height))
		abort();
	err = frame_decode(decoder, frame, &canvas, &fault);
	if (err && !fault.text[0])
		abort();
	if (!err)
		check_opaque(&canvas);
	canvas_free(&canvas);
	frame_decoder_destroy(decoder);
}

/* Reads the view and a part of it, as a compositor does. */
static void read_view(const struct frame *frame, struct view view)
{
	struct fault fault = {""};
	struct frame_reader reader;
	struct canvas canvas;

	if (view_resolve(&view, frame->width, frame->height, &fault) ||
	    frame_reader_open(&reader, frame, &view, &fault)) {
		if (!fault.text[0])
			abort();
		return;
	}
	if (canvas_create(&canvas, view.width, view.height))
		abort();
	frame_reader_make(&reader, 0, 0, view.width, view.height, canvas.pixels, canvas.stride);
	check_opaque(&canvas);
	frame_reader_make(&reader, view.width / 3, view.height / 2, view.width - view.width / 3,
			  view.height - view.height / 2, canvas.pixels, canvas.stride);
	canvas_free(&canvas);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	const uint8_t *head = data;
	struct frame frame;
	struct view view;

	if (bytes < HEAD)
		return 0;
	data += HEAD;
	bytes -= HEAD;
	frame = (struct frame){.format = head[0] % PIXEL_FORMAT_COUNT,
			       .width = 1 + head[1] % 80,
			       .height = 1 + head[2] % 24,
			       .fields = head[3] % FIELDS_COUNT,
			       .bottom_first = head[4] & 1,
			       .matrix = head[4] >> 1 & 1,
			       .range = head[4] >> 2 & 1};
	view = (struct view){head[7] % 80,
			     head[8] % 24,
			     head[9] % 80,
			     head[10] % 24,
			     head[4] >> 3 & 1,
			     head[4] >> 4 & 1,
			     1};
	fuzz_frame_fill(frame.planes, &frame, frame.height, head[5] % 9, &data, &bytes);
	fuzz_frame_fill(frame.bottom_planes, &frame, frame.height / 2, head[5] % 9, &data, &bytes);
	decode(&frame, head[6] % DEINTERLACE_COUNT);
	if (frame_is_raw(&frame))
		read_view(&frame, view);
	for (int k = 0; k < PLANES; k++) {
		free((void *)frame.planes[k].data);
		free((void *)frame.bottom_planes[k].data);
	}
	return 0;
}
