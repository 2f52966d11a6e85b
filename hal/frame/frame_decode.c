/* SPDX-License-Identifier: MIT */
#include "hal/frame/frame_decode.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/frame/frame_reader.h"

struct frame_decoder {
	enum deinterlace deinterlace;
	struct jpeg_decoder *jpeg;
	uint8_t *rows; /* two rows of pixels, for blending */
	int rows_width;
	struct canvas unpacked; /* MJPEG in fields */
	enum picture_turn turn;
	struct canvas as_sent; /* a picture that is still to be turned */
};

int frame_decoder_create(struct frame_decoder **decoder, enum deinterlace deinterlace,
			 enum picture_turn turn)
{
	struct frame_decoder *d = calloc(1, sizeof(*d));
	int err;

	*decoder = NULL;
	if (!d)
		return -ENOMEM;
	d->deinterlace = deinterlace;
	d->turn = turn;
	err = jpeg_decoder_create(&d->jpeg);
	if (err) {
		free(d);
		return err;
	}
	*decoder = d;
	return 0;
}

void frame_decoder_destroy(struct frame_decoder *decoder)
{
	if (!decoder)
		return;
	jpeg_decoder_destroy(decoder->jpeg);
	canvas_free(&decoder->unpacked);
	canvas_free(&decoder->as_sent);
	free(decoder->rows);
	free(decoder);
}

static int grow_rows(struct frame_decoder *decoder, int width)
{
	uint8_t *rows;

	if (decoder->rows_width >= width)
		return 0;
	rows = malloc(2 * 4 * (size_t)width);
	if (!rows)
		return -ENOMEM;
	free(decoder->rows);
	decoder->rows = rows;
	decoder->rows_width = width;
	return 0;
}

/* Decodes a progressive picture, or one field as a progressive picture. */
static int decode_picture(struct frame_decoder *decoder, const struct frame *frame,
			  struct canvas *canvas, struct fault *fault)
{
	const struct view whole = {.width = frame->width, .height = frame->height, .squash = 1};
	struct frame_reader reader;
	int err;

	if (frame->format == PIXEL_MJPEG)
		return frame_jpeg_decode(decoder->jpeg, &frame->planes[0], canvas, fault);
	err = frame_reader_open(&reader, frame, &whole, fault);
	if (err)
		return err;
	frame_reader_make(&reader, 0, 0, frame->width, frame->height, canvas->pixels,
			  canvas->stride);
	return 0;
}

static int decode_field(struct frame_decoder *decoder, const struct frame *frame, bool bottom,
			struct canvas *canvas, struct fault *fault)
{
	const struct frame field = frame_fields_one(frame, bottom);
	struct canvas lines = canvas_field(canvas, bottom);

	return decode_picture(decoder, &field, &lines, fault);
}

static int decode_jpeg_fields(struct frame_decoder *decoder, const struct frame *frame,
			      struct canvas *upper, struct canvas *lower, struct fault *fault)
{
	struct frame_plane second;
	int err;

	err = frame_jpeg_decode(decoder->jpeg, &frame->planes[0], upper, fault);
	if (err || frame->fields == FIELDS_TOP || frame->fields == FIELDS_BOTTOM)
		return err;
	second = frame->fields == FIELDS_PAIR ? frame->bottom_planes[0]
					      : frame_jpeg_after(&frame->planes[0]);
	return frame_jpeg_decode(decoder->jpeg, &second, lower, fault);
}

/* Decodes MJPEG in fields to a BGRX frame whose fields can be separated. */
static int unpack_jpeg(struct frame_decoder *decoder, const struct frame *frame,
		       struct frame *unpacked, struct fault *fault)
{
	struct canvas *canvas = &decoder->unpacked, upper, lower;
	int width, height, err;

	if (canvas->width != frame->width || canvas->height != frame->height) {
		canvas_free(canvas);
		err = canvas_create(canvas, frame->width, frame->height);
		if (err)
			return fault_say(fault, err, "frame: no memory for two fields of %dx%d",
					 frame->width, frame->height);
	}
	err = frame_jpeg_size(decoder->jpeg, &frame->planes[0], &width, &height, fault);
	if (err)
		return err;
	*unpacked = *frame;
	unpacked->format = PIXEL_BGRX;
	unpacked->range = RANGE_FULL;
	unpacked->planes[0] = (struct frame_plane){canvas->pixels, canvas->stride,
						   canvas->stride * (size_t)canvas->height};
	if (height >= frame->height && frame->fields >= FIELDS_INTERLACED &&
	    frame->fields <= FIELDS_BOTTOM_TOP)
		return frame_jpeg_decode(decoder->jpeg, &frame->planes[0], canvas, fault);
	upper = lower = *canvas;
	upper.height = lower.height = canvas->height / 2;
	lower.pixels += canvas->stride * (size_t)upper.height;
	if (frame->fields == FIELDS_PAIR)
		unpacked->fields = FIELDS_TOP_BOTTOM;
	else if (frame->fields == FIELDS_INTERLACED)
		unpacked->fields = frame->bottom_first ? FIELDS_BOTTOM_TOP : FIELDS_TOP_BOTTOM;
	return decode_jpeg_fields(decoder, frame, &upper, &lower, fault);
}

static int decode_fields(struct frame_decoder *decoder, const struct frame *frame,
			 struct canvas *canvas, struct fault *fault)
{
	const bool both = frame_fields_has(frame, false) && frame_fields_has(frame, true);
	const bool alone = !both || decoder->deinterlace == DEINTERLACE_BOB;
	const bool later_is_bottom = both ? !frame->bottom_first : frame_fields_has(frame, true);
	struct frame unpacked;
	int err = frame_fields_check(frame, fault);

	if (err)
		return err;
	if (frame->format == PIXEL_MJPEG) {
		err = unpack_jpeg(decoder, frame, &unpacked, fault);
		if (err)
			return err;
		frame = &unpacked;
	}
	err = decode_field(decoder, frame, later_is_bottom, canvas, fault);
	if (err)
		return err;
	if (alone) {
		canvas_interpolate(canvas, later_is_bottom);
		return 0;
	}
	err = decode_field(decoder, frame, !later_is_bottom, canvas, fault);
	if (err)
		return err;
	if (decoder->deinterlace == DEINTERLACE_BLEND)
		canvas_blend(canvas, decoder->rows);
	return 0;
}

int frame_decoder_size(struct frame_decoder *decoder, const struct frame *frame, int *width,
		       int *height, struct fault *fault)
{
	int err;

	*width = frame->width;
	*height = frame->height;
	if (frame->format != PIXEL_MJPEG || frame->fields != FIELDS_NONE)
		return 0;
	err = frame_jpeg_size(decoder->jpeg, &frame->planes[0], width, height, fault);
	if (!err && frame_jpeg_holds(*width, *height, frame->width, frame->height)) {
		*width = frame->width;
		*height = frame->height;
	}
	return err;
}

static int decode_as_sent(struct frame_decoder *decoder, const struct frame *frame,
			  struct canvas *canvas, struct fault *fault)
{
	int err;

	if (frame->format <= PIXEL_NONE || frame->format > PIXEL_MJPEG)
		return fault_say(fault, -ENOTSUP,
				 "frame: a picture that is not of 8-bit code values");
	if (frame->width < 1 || frame->width != canvas->width || frame->height < 1 ||
	    frame->height != canvas->height)
		return fault_say(fault, -EINVAL, "frame: %dx%d into a canvas of %dx%d",
				 frame->width, frame->height, canvas->width, canvas->height);
	err = frame->fields == FIELDS_NONE ? 0 : grow_rows(decoder, frame->width);
	if (err)
		return fault_say(fault, err, "frame: no memory to convert %dx%d", frame->width,
				 frame->height);
	return frame->fields == FIELDS_NONE ? decode_picture(decoder, frame, canvas, fault)
					    : decode_fields(decoder, frame, canvas, fault);
}

int frame_decode(struct frame_decoder *decoder, const struct frame *frame, struct canvas *canvas,
		 struct fault *fault)
{
	const bool sideways = picture_turn_is_sideways(decoder->turn);
	const int width = sideways ? canvas->height : canvas->width;
	const int height = sideways ? canvas->width : canvas->height;
	int err;

	if (decoder->turn == PICTURE_UPRIGHT)
		return decode_as_sent(decoder, frame, canvas, fault);
	err = canvas_fit(&decoder->as_sent, width, height);
	if (err)
		return fault_say(fault, err, "frame: no memory to turn %dx%d", width, height);
	err = decode_as_sent(decoder, frame, &decoder->as_sent, fault);
	if (!err)
		canvas_turn(&decoder->as_sent, decoder->turn, canvas->pixels, canvas->stride);
	return err;
}
