#include <errno.h>
#include <libyuv.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "hal/frame.h"
#include "hal/frame_fields.h"
#include "hal/frame_jpeg.h"
#include "hal/frame_ycbcr.h"

/* Packed and interleaved chroma goes through planes, a strip at a time so that it stays in the
 * cache. */
enum { STRIP_ROWS = 16 };

struct frame_decoder {
	enum deinterlace deinterlace;
	struct frame_jpeg jpeg;
	uint8_t *strip; /* Y, U and V of STRIP_ROWS rows; two rows of pixels while blending */
	int strip_width;
	struct canvas unpacked; /* JPEG in fields */
};

int frame_decoder_create(struct frame_decoder **decoder, enum deinterlace deinterlace)
{
	struct frame_decoder *d = calloc(1, sizeof(*d));
	int err;

	*decoder = NULL;
	if (!d)
		return -ENOMEM;
	d->deinterlace = deinterlace;
	err = frame_jpeg_create(&d->jpeg);
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
	frame_jpeg_destroy(&decoder->jpeg);
	canvas_free(&decoder->unpacked);
	free(decoder->strip);
	free(decoder);
}

static int check_plane(const struct frame *frame, int plane, struct fault *fault)
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

static int check_planes(const struct frame *frame, struct fault *fault)
{
	const int planes = frame->format == PIXEL_NV12 ? 2 : 1;

	for (int i = 0; i < planes; i++) {
		int err = check_plane(frame, i, fault);

		if (err)
			return err;
	}
	return 0;
}

static int grow_strip(struct frame_decoder *decoder, int width)
{
	const size_t chroma = ((size_t)width + 1) / 2;
	uint8_t *strip;

	if (decoder->strip_width >= width)
		return 0;
	strip = malloc(STRIP_ROWS * ((size_t)width + 2 * chroma));
	if (!strip)
		return -ENOMEM;
	free(decoder->strip);
	decoder->strip = strip;
	decoder->strip_width = width;
	return 0;
}

static uint32_t *row_of(const struct canvas *canvas, int y)
{
	return (uint32_t *)(void *)(canvas->pixels + (size_t)y * canvas->stride);
}

static int decode_packed(struct frame_decoder *decoder, const struct frame *frame,
			 struct canvas *canvas)
{
	const int width = frame->width, chroma = (width + 1) / 2;
	const int stride = (int)frame->planes[0].stride;
	uint8_t *y = decoder->strip;
	uint8_t *u = y + (size_t)width * STRIP_ROWS;
	uint8_t *v = u + (size_t)chroma * STRIP_ROWS;
	struct ycbcr k;

	ycbcr_prepare(&k, frame->matrix, frame->range);
	for (int row = 0; row < frame->height; row += STRIP_ROWS) {
		const int left = frame->height - row;
		const int rows = left < STRIP_ROWS ? left : STRIP_ROWS;
		const uint8_t *from = frame->planes[0].data + (size_t)row * frame->planes[0].stride;
		const int err = frame->format == PIXEL_YUYV
					? YUY2ToI422(from, stride, y, width, u, chroma, v, chroma,
						     width, rows)
					: UYVYToI422(from, stride, y, width, u, chroma, v, chroma,
						     width, rows);

		if (err)
			return -EINVAL;
		for (int i = 0; i < rows; i++)
			ycbcr_row_halved(&k, y + i * width, u + i * chroma, v + i * chroma, width,
					 row_of(canvas, row + i));
	}
	return 0;
}

static int decode_nv12(struct frame_decoder *decoder, const struct frame *frame,
		       struct canvas *canvas)
{
	const int chroma = (frame->width + 1) / 2;
	uint8_t *u = decoder->strip, *v = u + chroma;
	struct ycbcr k;

	ycbcr_prepare(&k, frame->matrix, frame->range);
	for (int row = 0; row < frame->height; row++) {
		const struct frame_plane *p = frame->planes;

		if (row % 2 == 0)
			SplitUVPlane(p[1].data + (size_t)(row / 2) * p[1].stride, 0, u, 0, v, 0,
				     chroma, 1);
		ycbcr_row_halved(&k, p[0].data + (size_t)row * p[0].stride, u, v, frame->width,
				 row_of(canvas, row));
	}
	return 0;
}

static void decode_grey(const struct frame *frame, struct canvas *canvas)
{
	struct ycbcr k;

	ycbcr_prepare(&k, frame->matrix, frame->range);
	for (int y = 0; y < frame->height; y++)
		ycbcr_row_grey(&k, frame->planes[0].data + (size_t)y * frame->planes[0].stride,
			       frame->width, row_of(canvas, y));
}

/* The fourth byte of a camera's pixel is whatever the driver left there. */
static void copy_bgrx(const struct frame *frame, struct canvas *canvas)
{
	for (int y = 0; y < frame->height; y++) {
		const uint8_t *from = frame->planes[0].data + (size_t)y * frame->planes[0].stride;
		uint8_t *to = canvas->pixels + (size_t)y * canvas->stride;

		memcpy(to, from, (size_t)frame->width * 4);
		for (int x = 0; x < frame->width; x++)
			to[x * 4 + 3] = 255;
	}
}

static void expand(struct canvas *canvas)
{
	struct ycbcr k;

	ycbcr_prepare(&k, MATRIX_BT601, RANGE_LIMITED);
	for (int y = 0; y < canvas->height; y++)
		ycbcr_row_expand(&k, canvas->width, row_of(canvas, y));
}

static int decode_rgb(const struct frame *frame, struct canvas *canvas)
{
	const uint8_t *from = frame->planes[0].data;
	const int stride = (int)frame->planes[0].stride, out_stride = (int)canvas->stride;
	int err = 0;

	if (frame->format == PIXEL_RGB24) /* libyuv's "RAW" */
		err = RAWToARGB(from, stride, canvas->pixels, out_stride, frame->width,
				frame->height);
	else if (frame->format == PIXEL_BGR24) /* libyuv's "RGB24" */
		err = RGB24ToARGB(from, stride, canvas->pixels, out_stride, frame->width,
				  frame->height);
	else
		copy_bgrx(frame, canvas);
	if (err)
		return -EINVAL;
	if (frame->range == RANGE_LIMITED)
		expand(canvas);
	return 0;
}

static int convert(struct frame_decoder *decoder, const struct frame *frame, struct canvas *canvas)
{
	switch (frame->format) {
	case PIXEL_YUYV:
	case PIXEL_UYVY:
		return decode_packed(decoder, frame, canvas);
	case PIXEL_NV12:
		return decode_nv12(decoder, frame, canvas);
	case PIXEL_GREY:
		decode_grey(frame, canvas);
		return 0;
	default:
		return decode_rgb(frame, canvas);
	}
}

/* A progressive picture, or a field as one. */
static int decode_picture(struct frame_decoder *decoder, const struct frame *frame,
			  struct canvas *canvas, struct fault *fault)
{
	int err;

	if (frame->format == PIXEL_MJPEG)
		return frame_jpeg_decode(&decoder->jpeg, &frame->planes[0], canvas, fault);
	err = check_planes(frame, fault);
	if (err)
		return err;
	err = convert(decoder, frame, canvas);
	if (err)
		return fault_say(fault, err, "frame: cannot convert %s at %dx%d",
				 pixel_format_names[frame->format], frame->width, frame->height);
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

	err = frame_jpeg_decode(&decoder->jpeg, &frame->planes[0], upper, fault);
	if (err || frame->fields == FIELDS_TOP || frame->fields == FIELDS_BOTTOM)
		return err;
	second = frame->fields == FIELDS_PAIR ? frame->bottom_planes[0]
					      : frame_jpeg_after(&frame->planes[0]);
	return frame_jpeg_decode(&decoder->jpeg, &second, lower, fault);
}

/* JPEG as a frame that can be taken apart into fields. */
static int unpack_jpeg(struct frame_decoder *decoder, const struct frame *frame,
		       struct frame *unpacked, struct fault *fault)
{
	struct canvas *canvas = &decoder->unpacked, upper, lower;
	int height, err;

	if (canvas->width != frame->width || canvas->height != frame->height) {
		canvas_free(canvas);
		err = canvas_create(canvas, frame->width, frame->height);
		if (err)
			return fault_say(fault, err, "frame: no memory for two fields of %dx%d",
					 frame->width, frame->height);
	}
	err = frame_jpeg_height(&decoder->jpeg, &frame->planes[0], &height, fault);
	if (err)
		return err;
	*unpacked = *frame;
	unpacked->format = PIXEL_BGRX;
	unpacked->range = RANGE_FULL;
	unpacked->planes[0] = (struct frame_plane){canvas->pixels, canvas->stride,
						   canvas->stride * (size_t)canvas->height};
	if (height == frame->height && frame->fields >= FIELDS_INTERLACED &&
	    frame->fields <= FIELDS_BOTTOM_TOP)
		return frame_jpeg_decode(&decoder->jpeg, &frame->planes[0], canvas, fault);
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
		canvas_blend(canvas, decoder->strip);
	return 0;
}

int frame_decode(struct frame_decoder *decoder, const struct frame *frame, struct canvas *canvas,
		 struct fault *fault)
{
	int err;

	if (frame->format <= PIXEL_NONE || frame->format > PIXEL_MJPEG)
		return fault_say(fault, -ENOTSUP,
				 "frame: a picture that is not of 8-bit code values");
	if (frame->width < 1 || frame->width != canvas->width || frame->height < 1 ||
	    frame->height != canvas->height)
		return fault_say(fault, -EINVAL, "frame: %dx%d into a canvas of %dx%d",
				 frame->width, frame->height, canvas->width, canvas->height);
	err = grow_strip(decoder, frame->width);
	if (err)
		return fault_say(fault, err, "frame: no memory to convert %dx%d", frame->width,
				 frame->height);
	return frame->fields == FIELDS_NONE ? decode_picture(decoder, frame, canvas, fault)
					    : decode_fields(decoder, frame, canvas, fault);
}
