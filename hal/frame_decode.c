#include <errno.h>
#include <libyuv.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <turbojpeg.h>

#include "hal/frame.h"
#include "hal/frame_ycbcr.h"

/* Packed and interleaved chroma goes through planes, a strip at a time so that it stays in the
 * cache. */
enum { STRIP_ROWS = 16 };

struct frame_decoder {
	enum deinterlace deinterlace;
	tjhandle jpeg;
	uint8_t *strip; /* Y, U and V of STRIP_ROWS rows */
	int strip_width;
};

int frame_decoder_create(struct frame_decoder **decoder, enum deinterlace deinterlace)
{
	struct frame_decoder *d = calloc(1, sizeof(*d));

	*decoder = NULL;
	if (!d)
		return -ENOMEM;
	d->jpeg = tjInitDecompress();
	if (!d->jpeg) {
		free(d);
		return -ENOMEM;
	}
	*decoder = d;
	return 0;
}

void frame_decoder_destroy(struct frame_decoder *decoder)
{
	if (!decoder)
		return;
	if (decoder->jpeg)
		tjDestroy(decoder->jpeg);
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

/* Some webcams put stray bytes between the last scan and its end marker in every picture; the
 * picture is whole. Any other complaint means that part of it is missing or made up. */
static int jpeg_is_damaged(tjhandle jpeg)
{
	return tjGetErrorCode(jpeg) != TJERR_WARNING ||
	       !strstr(tjGetErrorStr2(jpeg), "extraneous bytes");
}

/* TurboJPEG does not recover by itself from a header that it gave up in the middle of: every later
 * picture would fail too. */
static int refuse_header(struct frame_decoder *decoder, struct fault *fault)
{
	fault_say(fault, -EBADMSG, "frame: not a JPEG picture: %s", tjGetErrorStr2(decoder->jpeg));
	tjDestroy(decoder->jpeg);
	decoder->jpeg = tjInitDecompress();
	return -EBADMSG;
}

static int decode_jpeg(struct frame_decoder *decoder, const struct frame *frame,
		       struct canvas *canvas, struct fault *fault)
{
	const uint8_t *data = frame->planes[0].data;
	const size_t bytes = frame->planes[0].bytes;
	int width, height, subsampling, colours;

	if (!data || bytes == 0)
		return fault_say(fault, -EBADMSG, "frame: an empty JPEG picture");
	if (!decoder->jpeg)
		return fault_say(fault, -ENOMEM, "frame: no memory to decode JPEG pictures");
	if (tjDecompressHeader3(decoder->jpeg, data, bytes, &width, &height, &subsampling,
				&colours))
		return refuse_header(decoder, fault);
	if (width != frame->width || height != frame->height)
		return fault_say(fault, -EBADMSG, "frame: a JPEG picture of %dx%d, expected %dx%d",
				 width, height, frame->width, frame->height);
	/* BGRA, not BGRX: the former sets the fourth byte to 255. */
	if (tjDecompress2(decoder->jpeg, data, bytes, canvas->pixels, width, (int)canvas->stride,
			  height, TJPF_BGRA, TJFLAG_ACCURATEDCT | TJFLAG_LIMITSCANS) &&
	    jpeg_is_damaged(decoder->jpeg))
		return fault_say(fault, -EBADMSG, "frame: a damaged JPEG picture: %s",
				 tjGetErrorStr2(decoder->jpeg));
	return 0;
}

static int decode_raw(struct frame_decoder *decoder, const struct frame *frame,
		      struct canvas *canvas)
{
	const struct frame_plane *p = frame->planes;
	const int stride = (int)p[0].stride, out_stride = (int)canvas->stride;
	const int width = frame->width, height = frame->height;

	switch (frame->format) {
	case PIXEL_YUYV:
	case PIXEL_UYVY:
		return decode_packed(decoder, frame, canvas);
	case PIXEL_NV12:
		return decode_nv12(decoder, frame, canvas);
	case PIXEL_RGB24: /* libyuv's "RAW" */
		return RAWToARGB(p[0].data, stride, canvas->pixels, out_stride, width, height)
			       ? -EINVAL
			       : 0;
	case PIXEL_BGR24: /* libyuv's "RGB24" */
		return RGB24ToARGB(p[0].data, stride, canvas->pixels, out_stride, width, height)
			       ? -EINVAL
			       : 0;
	case PIXEL_GREY:
		decode_grey(frame, canvas);
		return 0;
	default:
		copy_bgrx(frame, canvas);
		return 0;
	}
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
	if (frame->format == PIXEL_MJPEG)
		return decode_jpeg(decoder, frame, canvas, fault);
	err = check_planes(frame, fault);
	if (err)
		return err;
	err = grow_strip(decoder, frame->width);
	if (err)
		return fault_say(fault, err, "frame: no memory to convert %dx%d", frame->width,
				 frame->height);
	err = decode_raw(decoder, frame, canvas);
	if (err)
		return fault_say(fault, err, "frame: cannot convert %s at %dx%d",
				 pixel_format_names[frame->format], frame->width, frame->height);
	return 0;
}
