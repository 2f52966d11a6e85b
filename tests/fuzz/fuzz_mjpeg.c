/* SPDX-License-Identifier: MIT */
/*
 * Any bytes as what a camera calls a Motion JPEG frame, progressive and in each order of fields: a
 * picture or a clear refusal, and the decoder goes on after either.
 *
 * reaches: frame_jpeg.c:frame_jpeg_decode frame_jpeg.c:frame_jpeg_after
 * jpeg_decoder.c:jpeg_decoder_read frame_decode.c:decode_jpeg_fields frame_decode.c:decode_fields
 */
#include <stdint.h>
#include <stdlib.h>

#include "hal/frame/frame_decode.h"

enum { WIDTH = 32, HEIGHT = 32 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

static void decode(struct frame_decoder *decoder, const struct frame *frame, struct canvas *canvas)
{
	struct fault fault = {""};
	const int err = frame_decode(decoder, frame, canvas, &fault);

	if (err && !fault.text[0])
		abort();
	for (int y = 0; y < HEIGHT && !err; y++)
		for (int x = 0; x < WIDTH; x++)
			if (canvas->pixels[(size_t)y * canvas->stride + (size_t)x * 4 + 3] != 255)
				abort();
}

/* The first byte tells the length of the first field, for fields in separate memory. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	static struct frame_decoder *decoder;
	static struct canvas canvas;
	struct frame frame = {.format = PIXEL_MJPEG, .width = WIDTH, .height = HEIGHT};
	size_t first;

	if (bytes == 0)
		return 0;
	if (!decoder && (frame_decoder_create(&decoder, DEINTERLACE_WEAVE, PICTURE_UPRIGHT) ||
			 canvas_create(&canvas, WIDTH, HEIGHT)))
		abort();
	first = (bytes - 1) * data[0] / 255;
	for (int fields = FIELDS_NONE; fields < FIELDS_COUNT; fields++) {
		const bool pair = fields == FIELDS_PAIR;

		frame.fields = (enum frame_fields)fields;
		frame.planes[0] = (struct frame_plane){data + 1, 0, pair ? first : bytes - 1};
		frame.bottom_planes[0] = (struct frame_plane){data + 1 + first, 0,
							      bytes - 1 - first};
		decode(decoder, &frame, &canvas);
	}
	return 0;
}
