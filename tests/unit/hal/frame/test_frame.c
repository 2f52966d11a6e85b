/* SPDX-License-Identifier: MIT */
/* Frames into BGRX: every format against conversion in double precision, every check on sizes. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <turbojpeg.h>

#include "hal/frame/frame_decode.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

static uint32_t random_state = 20261120;

static uint32_t random_bits(void)
{
	random_state ^= random_state << 13;
	random_state ^= random_state >> 17;
	random_state ^= random_state << 5;
	return random_state;
}

static void fill_random(uint8_t *data, size_t bytes)
{
	for (size_t i = 0; i < bytes; i++)
		data[i] = (uint8_t)(random_bits() >> 11);
}

/* RGB by ITU-R BT.601-7 and BT.709-6; 0..255, clipped, not rounded. */
static void exact_rgb(enum colour_matrix matrix, enum colour_range range, int y, int cb, int cr,
		      double rgb[3])
{
	const double kr = matrix == MATRIX_BT709 ? 0.2126 : 0.299;
	const double kb = matrix == MATRIX_BT709 ? 0.0722 : 0.114;
	const double luma = range == RANGE_FULL ? y : (y - 16) * 255.0 / 219;
	const double scale = range == RANGE_FULL ? 1 : 255.0 / 224;
	const double pb = (cb - 128) * scale, pr = (cr - 128) * scale;

	rgb[0] = luma + 2 * (1 - kr) * pr;
	rgb[2] = luma + 2 * (1 - kb) * pb;
	rgb[1] = (luma - kr * rgb[0] - kb * rgb[2]) / (1 - kr - kb);
	for (int c = 0; c < 3; c++)
		rgb[c] = fmin(fmax(rgb[c], 0), 255);
}

struct fixture {
	struct frame_decoder *decoder;
	struct frame frame;
	struct canvas canvas;
	uint8_t *memory[FRAME_PLANES];
};

/* Makes a random picture; rows have `extra` bytes of padding, but the last row has none. */
static void test_frame_make(struct fixture *f, enum pixel_format format, int width, int height,
			    size_t extra)
{
	memset(f, 0, sizeof(*f));
	assert_int_equal(frame_decoder_create(&f->decoder, DEINTERLACE_WEAVE, PICTURE_UPRIGHT), 0);
	assert_int_equal(canvas_create(&f->canvas, width, height), 0);
	f->frame = (struct frame){
		.format = format, .width = width, .height = height, .range = RANGE_FULL};
	for (int p = 0; p < frame_plane_count(format); p++) {
		const size_t row = frame_plane_stride(format, p, width);
		const size_t stride = row + extra;
		const size_t bytes = frame_plane_bytes(format, p, stride, height) - extra;

		f->memory[p] = malloc(bytes);
		fill_random(f->memory[p], bytes);
		f->frame.planes[p] = (struct frame_plane){f->memory[p], stride, bytes};
	}
}

static void test_frame_drop(struct fixture *f)
{
	frame_decoder_destroy(f->decoder);
	canvas_free(&f->canvas);
	for (int p = 0; p < FRAME_PLANES; p++)
		free(f->memory[p]);
}

static const uint8_t *at(const struct frame *frame, int plane, int x, int y)
{
	return frame->planes[plane].data + (size_t)y * frame->planes[plane].stride + x;
}

static void ycbcr_at(const struct frame *frame, int x, int y, int ycbcr[3])
{
	const int pair = x / 2, rows = frame->format == PIXEL_NV16 ? 1 : 2;

	switch (frame->format) {
	case PIXEL_YUYV:
		ycbcr[0] = *at(frame, 0, 2 * x, y);
		ycbcr[1] = *at(frame, 0, 4 * pair + 1, y);
		ycbcr[2] = *at(frame, 0, 4 * pair + 3, y);
		break;
	case PIXEL_UYVY:
		ycbcr[0] = *at(frame, 0, 2 * x + 1, y);
		ycbcr[1] = *at(frame, 0, 4 * pair, y);
		ycbcr[2] = *at(frame, 0, 4 * pair + 2, y);
		break;
	case PIXEL_YVYU:
		ycbcr[0] = *at(frame, 0, 2 * x, y);
		ycbcr[1] = *at(frame, 0, 4 * pair + 3, y);
		ycbcr[2] = *at(frame, 0, 4 * pair + 1, y);
		break;
	case PIXEL_NV16:
	case PIXEL_NV12:
		ycbcr[0] = *at(frame, 0, x, y);
		ycbcr[1] = *at(frame, 1, 2 * pair, y / rows);
		ycbcr[2] = *at(frame, 1, 2 * pair + 1, y / rows);
		break;
	case PIXEL_NV21:
		ycbcr[0] = *at(frame, 0, x, y);
		ycbcr[1] = *at(frame, 1, 2 * pair + 1, y / 2);
		ycbcr[2] = *at(frame, 1, 2 * pair, y / 2);
		break;
	case PIXEL_YU12:
	case PIXEL_YV12:
		ycbcr[0] = *at(frame, 0, x, y);
		ycbcr[1] = *at(frame, frame->format == PIXEL_YU12 ? 1 : 2, pair, y / 2);
		ycbcr[2] = *at(frame, frame->format == PIXEL_YU12 ? 2 : 1, pair, y / 2);
		break;
	default:
		ycbcr[0] = *at(frame, 0, x, y);
		ycbcr[1] = ycbcr[2] = 128;
		break;
	}
}

static double worst_error(const struct fixture *f, double *rms)
{
	double worst = 0, sum = 0;

	for (int y = 0; y < f->frame.height; y++)
		for (int x = 0; x < f->frame.width; x++) {
			const uint8_t *got = f->canvas.pixels + (size_t)y * f->canvas.stride +
					     (size_t)x * 4;
			int ycbcr[3];
			double rgb[3];

			ycbcr_at(&f->frame, x, y, ycbcr);
			exact_rgb(f->frame.matrix, f->frame.range, ycbcr[0], ycbcr[1], ycbcr[2],
				  rgb);
			for (int c = 0; c < 3; c++) {
				worst = fmax(worst, fabs(rgb[c] - got[2 - c]));
				sum += (rgb[c] - got[2 - c]) * (rgb[c] - got[2 - c]);
			}
			expect_equal(got[3], 255, "y=%d, x=%d", y, x);
		}
	*rms = sqrt(sum / (3.0 * f->frame.width * f->frame.height));
	return worst;
}

/* Half a level for rounding, and a little for single precision. */
static const double error_max = 0.501;

TEST("video formats match double precision")
{
	static const enum pixel_format formats[] = {PIXEL_YUYV, PIXEL_UYVY, PIXEL_YVYU,
						    PIXEL_NV16, PIXEL_NV12, PIXEL_NV21,
						    PIXEL_YU12, PIXEL_YV12, PIXEL_GREY};

	for (size_t i = 0; i < sizeof(formats) / sizeof(formats[0]); i++)
		for (int matrix = 0; matrix < MATRIX_COUNT; matrix++)
			for (int range = 0; range < RANGE_COUNT; range++) {
				struct fixture f;
				double worst, rms;

				test_frame_make(&f, formats[i], 642, 358, 24);
				f.frame.matrix = (enum colour_matrix)matrix;
				f.frame.range = (enum colour_range)range;
				assert_int_equal(frame_decode(f.decoder, &f.frame, &f.canvas, NULL),
						 0);
				worst = worst_error(&f, &rms);
				print_message("# %s, %s, %s: largest error %.2f levels, RMS %.2f\n",
					      pixel_format_names[formats[i]],
					      matrix ? "BT.709" : "BT.601",
					      range ? "full" : "limited", worst, rms);
				expect_at_most(worst, error_max, "%s, matrix %d, range %d",
					       pixel_format_names[formats[i]], matrix, range);
				test_frame_drop(&f);
			}
}

/* Ten and sixteen bits are rounded to eight. */
TEST("deep formats match double precision")
{
	static const enum pixel_format formats[] = {PIXEL_P010, PIXEL_Y10, PIXEL_Y12, PIXEL_Y14,
						    PIXEL_Y16};
	static const double whites[] = {0, 1023, 4095, 16383, 65535};

	for (int i = 0; i < 5; i++) {
		const double white = whites[i];
		struct fixture f;

		test_frame_make(&f, formats[i], 61, 33, 6);
		f.frame.range = formats[i] == PIXEL_P010 ? RANGE_LIMITED : RANGE_FULL;
		assert_int_equal(frame_decode(f.decoder, &f.frame, &f.canvas, NULL), 0);
		for (int y = 0; y < 33; y++)
			for (int x = 0; x < 61; x++) {
				const uint8_t *got = f.canvas.pixels + (size_t)y * f.canvas.stride +
						     (size_t)x * 4;
				const int word = at(&f.frame, 0, 2 * x, y)[0] |
						 at(&f.frame, 0, 2 * x, y)[1] << 8;
				double rgb[3];
				int eight[3];

				if (formats[i] != PIXEL_P010) {
					expect_at_most(
						fabs(got[1] - (word & (int)white) * 255 / white),
						0.501, "%d, %d, format %d", x, y, i);
					continue;
				}
				eight[0] = ((word >> 6) + 2) >> 2;
				for (int c = 0; c < 2; c++) {
					const uint8_t *w = at(&f.frame, 1, x / 2 * 4 + 2 * c,
							      y / 2);

					eight[1 + c] = (((w[0] | w[1] << 8) >> 6) + 2) >> 2;
				}
				for (int c = 0; c < 3; c++)
					eight[c] = eight[c] < 255 ? eight[c] : 255;
				exact_rgb(f.frame.matrix, f.frame.range, eight[0], eight[1],
					  eight[2], rgb);
				for (int c = 0; c < 3; c++)
					expect_at_most(fabs(got[2 - c] - rgb[c]), error_max,
						       "%d, %d, %d", x, y, c);
			}
		test_frame_drop(&f);
	}
}

/* Grey stays grey; black and white are exact. */
TEST("grey stays grey")
{
	for (int matrix = 0; matrix < MATRIX_COUNT; matrix++)
		for (int range = 0; range < RANGE_COUNT; range++) {
			struct fixture f;

			test_frame_make(&f, PIXEL_YUYV, 256, 1, 0);
			f.frame.matrix = (enum colour_matrix)matrix;
			f.frame.range = (enum colour_range)range;
			for (int x = 0; x < 256; x++) {
				f.memory[0][2 * x] = (uint8_t)x;
				f.memory[0][2 * x + 1] = 128;
			}
			assert_int_equal(frame_decode(f.decoder, &f.frame, &f.canvas, NULL), 0);
			for (int x = 0; x < 256; x++) {
				const uint8_t *p = f.canvas.pixels + (size_t)x * 4;

				expect_equal(p[0], p[1], "luma %d, matrix %d, range %d", x, matrix,
					     range);
				expect_equal(p[1], p[2], "luma %d, matrix %d, range %d", x, matrix,
					     range);
			}
			expect_equal(f.canvas.pixels[(range ? 0 : 16) * 4], 0,
				     "matrix=%d, range=%d", matrix, range);
			expect_equal(f.canvas.pixels[(range ? 255 : 235) * 4], 255,
				     "matrix=%d, range=%d", matrix, range);
			test_frame_drop(&f);
		}
}

TEST("rgb formats are exact")
{
	static const struct {
		enum pixel_format format;
		int bytes, red, blue;
	} cases[] = {{PIXEL_RGB24, 3, 0, 2}, {PIXEL_BGR24, 3, 2, 0}, {PIXEL_BGRX, 4, 2, 0}};

	for (size_t i = 0; i < 3; i++)
		for (int width = 1; width <= 65; width++) {
			struct fixture f;

			test_frame_make(&f, cases[i].format, width, 5, 7);
			assert_int_equal(frame_decode(f.decoder, &f.frame, &f.canvas, NULL), 0);
			for (int y = 0; y < 5; y++)
				for (int x = 0; x < width; x++) {
					const uint8_t *from = at(&f.frame, 0, x * cases[i].bytes,
								 y);
					const uint8_t *to = f.canvas.pixels +
							    (size_t)y * f.canvas.stride +
							    (size_t)x * 4;

					expect_equal(to[0], from[cases[i].blue],
						     "blue of (%d, %d), %d wide, format %d", x, y,
						     width, cases[i].format);
					expect_equal(to[1], from[1],
						     "green of (%d, %d), %d wide, format %d", x, y,
						     width, cases[i].format);
					expect_equal(to[2], from[cases[i].red],
						     "red of (%d, %d), %d wide, format %d", x, y,
						     width, cases[i].format);
					expect_equal(to[3], 255,
						     "fourth byte of (%d, %d), %d wide, format %d",
						     x, y, width, cases[i].format);
				}
			test_frame_drop(&f);
		}
}

/* 16 is black and 235 white; values beyond are clipped. */
TEST("limited rgb is expanded")
{
	static const enum pixel_format formats[] = {PIXEL_RGB24, PIXEL_BGR24, PIXEL_BGRX};

	for (int i = 0; i < 3; i++) {
		const int bytes = formats[i] == PIXEL_BGRX ? 4 : 3;
		struct fixture f;

		test_frame_make(&f, formats[i], 256, 3, 5);
		f.frame.range = RANGE_LIMITED;
		for (int x = 0; x < 256; x++)
			memset(f.memory[0] + x * bytes, x, (size_t)bytes);
		assert_int_equal(frame_decode(f.decoder, &f.frame, &f.canvas, NULL), 0);
		for (int x = 0; x < 256; x++) {
			const double exact = fmin(fmax((x - 16) * 255.0 / 219, 0), 255);
			const uint8_t *got = f.canvas.pixels + (size_t)x * 4;

			for (int c = 0; c < 3; c++)
				expect_at_most(fabs(got[c] - exact), error_max,
					       "value %d, channel %d, format %d", x, c, formats[i]);
			expect_equal(got[3], 255, "i=%d, x=%d", i, x);
		}
		test_frame_drop(&f);
	}
}

/* Odd sizes: the last chroma sample belongs to a pixel that does not exist, and memory ends right
 * behind the picture. */
TEST("odd sizes decode")
{
	static const enum pixel_format formats[] = {PIXEL_YUYV, PIXEL_UYVY, PIXEL_YVYU, PIXEL_NV16,
						    PIXEL_NV12, PIXEL_NV21, PIXEL_YU12, PIXEL_YV12};

	for (size_t i = 0; i < 8; i++)
		for (int width = 1; width <= 35; width++)
			for (int height = 1; height <= 35; height += 2) {
				struct fixture f;
				double rms;

				test_frame_make(&f, formats[i], width, height, (size_t)(width % 3));
				assert_int_equal(frame_decode(f.decoder, &f.frame, &f.canvas, NULL),
						 0);
				expect_at_most(worst_error(&f, &rms), error_max, "%dx%d, format %d",
					       width, height, formats[i]);
				test_frame_drop(&f);
			}
}

TEST("sizes are known")
{
	assert_int_equal(frame_plane_stride(PIXEL_YUYV, 0, 5), 12);
	assert_int_equal(frame_plane_stride(PIXEL_NV12, 0, 5), 5);
	assert_int_equal(frame_plane_stride(PIXEL_NV12, 1, 5), 6);
	assert_int_equal(frame_plane_stride(PIXEL_RGBF, 0, 5), 60);
	assert_int_equal(frame_plane_stride(PIXEL_BGRX, 1, 5), 0);
	assert_int_equal(frame_plane_bytes(PIXEL_NV12, 0, 8, 5), 40);
	assert_int_equal(frame_plane_bytes(PIXEL_NV12, 1, 8, 5), 24);
	assert_int_equal(frame_plane_bytes(PIXEL_MJPEG, 0, 8, 5), 0);
	assert_int_equal(frame_plane_bytes(PIXEL_NONE, 0, 8, 5), 0);
	assert_int_equal(frame_plane_bytes(PIXEL_NV12, 2, 8, 5), 0);
	assert_int_equal(frame_plane_bytes(PIXEL_NV12, -1, 8, 5), 0);
	for (int i = 0; i < PIXEL_FORMAT_COUNT; i++)
		assert_non_null(pixel_format_names[i]);
}

TEST("short planes are refused")
{
	for (int format = PIXEL_YUYV; format <= PIXEL_GREY; format++)
		for (int p = 0; p < frame_plane_count(format); p++) {
			struct frame_plane whole;
			struct fault fault = {""};
			struct fixture f;

			test_frame_make(&f, (enum pixel_format)format, 33, 9, 4);
			whole = f.frame.planes[p];
			f.frame.planes[p].bytes--;
			expect_equal(frame_decode(f.decoder, &f.frame, &f.canvas, &fault), -EINVAL,
				     "format=%d, p=%d", format, p);
			assert_non_null(strstr(fault.text, pixel_format_names[format]));
			f.frame.planes[p] = whole;
			f.frame.planes[p].stride =
				frame_plane_stride((enum pixel_format)format, p, 33) - 1;
			expect_equal(frame_decode(f.decoder, &f.frame, &f.canvas, NULL), -EINVAL,
				     "format=%d, p=%d", format, p);
			f.frame.planes[p] = whole;
			f.frame.planes[p].stride = (size_t)1 << 40;
			expect_equal(frame_decode(f.decoder, &f.frame, &f.canvas, NULL), -EINVAL,
				     "format=%d, p=%d", format, p);
			f.frame.planes[p] = whole;
			f.frame.planes[p].data = NULL;
			expect_equal(frame_decode(f.decoder, &f.frame, &f.canvas, NULL), -EINVAL,
				     "format=%d, p=%d", format, p);
			test_frame_drop(&f);
		}
}

TEST("other sizes and kinds are refused")
{
	struct fixture f;

	test_frame_make(&f, PIXEL_BGRX, 16, 16, 0);
	f.frame.width = 15;
	assert_int_equal(frame_decode(f.decoder, &f.frame, &f.canvas, NULL), -EINVAL);
	f.frame.width = 16;
	f.frame.height = 0;
	assert_int_equal(frame_decode(f.decoder, &f.frame, &f.canvas, NULL), -EINVAL);
	f.frame.height = 16;
	f.frame.format = PIXEL_RGBF;
	assert_int_equal(frame_decode(f.decoder, &f.frame, &f.canvas, NULL), -ENOTSUP);
	f.frame.format = PIXEL_NONE;
	assert_int_equal(frame_decode(f.decoder, &f.frame, &f.canvas, NULL), -ENOTSUP);
	test_frame_drop(&f);
}

/* A camera that hangs on its side: pixel (x, y) of the frame goes where its turn says. */
TEST("pictures are turned")
{
	for (int turn = 0; turn < PICTURE_TURN_COUNT; turn++) {
		const bool sideways = turn % 2;
		struct frame_decoder *decoder;
		struct canvas turned;
		struct fixture f;

		test_frame_make(&f, PIXEL_YUYV, 26, 14, 4);
		assert_int_equal(frame_decode(f.decoder, &f.frame, &f.canvas, NULL), 0);
		assert_int_equal(
			frame_decoder_create(&decoder, DEINTERLACE_WEAVE, (enum picture_turn)turn),
			0);
		assert_int_equal(canvas_create(&turned, sideways ? 14 : 26, sideways ? 26 : 14), 0);
		assert_int_equal(frame_decode(decoder, &f.frame, &turned, NULL), 0);
		for (int y = 0; y < 14; y++)
			for (int x = 0; x < 26; x++) {
				const int to[4][2] = {
					{x, y}, {13 - y, x}, {25 - x, 13 - y}, {y, 25 - x}};
				const uint8_t *from = f.canvas.pixels +
						      (size_t)y * f.canvas.stride + 4 * (size_t)x;
				const uint8_t *got = turned.pixels +
						     (size_t)to[turn][1] * turned.stride +
						     4 * (size_t)to[turn][0];

				for (int c = 0; c < 4; c++)
					expect_equal(got[c], from[c], "turn %d, (%d, %d)", turn, x,
						     y);
			}
		canvas_free(&turned);
		frame_decoder_destroy(decoder);
		test_frame_drop(&f);
	}
}

/* Compresses a picture with soft colours as JPEG. */
static size_t make_jpeg(int width, int height, int subsampling, uint8_t *rgb, uint8_t **jpeg)
{
	tjhandle handle = tjInitCompress();
	unsigned long bytes = 0;

	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++) {
			uint8_t *p = rgb + 3 * ((size_t)y * (size_t)width + (size_t)x);

			p[0] = (uint8_t)(40 + 170 * x / width);
			p[1] = (uint8_t)(200 - 150 * y / height);
			p[2] = (uint8_t)(60 + 60 * (x + y) / (width + height));
		}
	*jpeg = NULL;
	assert_int_equal(tjCompress2(handle, rgb, width, 0, height, TJPF_RGB, jpeg, &bytes,
				     subsampling, 95, TJFLAG_ACCURATEDCT),
			 0);
	tjDestroy(handle);
	return bytes;
}

static void make_jpeg_frame(struct fixture *f, int subsampling, uint8_t *rgb, uint8_t **jpeg)
{
	const size_t bytes = make_jpeg(64, 48, subsampling, rgb, jpeg);

	test_frame_make(f, PIXEL_BGRX, 64, 48, 0);
	f->frame.format = PIXEL_MJPEG;
	f->frame.planes[0] = (struct frame_plane){*jpeg, 0, bytes};
}

TEST("jpeg decodes")
{
	static const int subsamplings[] = {TJSAMP_444, TJSAMP_422, TJSAMP_420};
	uint8_t rgb[64 * 48 * 3];

	for (int i = 0; i < 3; i++) {
		struct fixture f;
		uint8_t *jpeg;
		int worst = 0;

		make_jpeg_frame(&f, subsamplings[i], rgb, &jpeg);
		assert_int_equal(frame_decode(f.decoder, &f.frame, &f.canvas, NULL), 0);
		for (int p = 0; p < 64 * 48; p++) {
			const uint8_t *got = f.canvas.pixels + (size_t)(p / 64) * f.canvas.stride +
					     p % 64 * 4;

			for (int c = 0; c < 3; c++)
				worst = abs(got[2 - c] - rgb[3 * p + c]) > worst
						? abs(got[2 - c] - rgb[3 * p + c])
						: worst;
			expect_equal(got[3], 255, "i=%d, p=%d", i, p);
		}
		print_message("# JPEG of quality 95: largest error %d levels\n", worst);
		expect_at_most(worst, 6, "subsampling %d", subsamplings[i]);
		test_frame_drop(&f);
		tjFree(jpeg);
	}
}

/* Motion JPEG may leave out the Huffman tables, which are always the same. */
TEST("jpeg without huffman tables decodes")
{
	uint8_t rgb[64 * 48 * 3], *jpeg;
	struct canvas whole;
	struct fixture f;
	size_t kept = 2, bytes;

	make_jpeg_frame(&f, TJSAMP_422, rgb, &jpeg);
	assert_int_equal(frame_decode(f.decoder, &f.frame, &f.canvas, NULL), 0);
	whole = f.canvas;
	assert_int_equal(canvas_create(&f.canvas, 64, 48), 0);
	bytes = f.frame.planes[0].bytes;
	for (size_t i = 2; i < bytes;) {
		const size_t length = 2 + (size_t)(jpeg[i + 2] << 8 | jpeg[i + 3]);

		if (jpeg[i + 1] == 0xda) { /* the scan: everything from here on */
			memmove(jpeg + kept, jpeg + i, bytes - i);
			kept += bytes - i;
			break;
		}
		if (jpeg[i + 1] != 0xc4) {
			memmove(jpeg + kept, jpeg + i, length);
			kept += length;
		}
		i += length;
	}
	assert_true(kept < bytes);
	f.frame.planes[0].bytes = kept;
	assert_int_equal(frame_decode(f.decoder, &f.frame, &f.canvas, NULL), 0);
	for (int y = 0; y < 48; y++)
		expect_same_picture(f.canvas.pixels + (size_t)y * f.canvas.stride,
				    whole.pixels + (size_t)y * whole.stride, f.canvas.stride,
				    (size_t)64 * 4, "row %d", y);
	canvas_free(&whole);
	test_frame_drop(&f);
	tjFree(jpeg);
}

TEST("damaged jpeg is refused")
{
	uint8_t rgb[64 * 48 * 3], *jpeg;
	struct fault fault = {""};
	struct fixture f;
	size_t bytes;

	make_jpeg_frame(&f, TJSAMP_420, rgb, &jpeg);
	bytes = f.frame.planes[0].bytes;
	f.frame.planes[0].bytes = 0;
	assert_int_equal(frame_decode(f.decoder, &f.frame, &f.canvas, &fault), -EBADMSG);
	for (size_t cut = 1; cut < bytes - 2; cut += 13) {
		f.frame.planes[0].bytes = cut;
		expect_equal(frame_decode(f.decoder, &f.frame, &f.canvas, &fault), -EBADMSG,
			     "cut=%zu", cut);
		expect_above(strlen(fault.text), 10, "JPEG cut to %zu bytes", cut);
	}
	/* Any flipped bit gives a picture or a refusal, and the decoder still works afterwards. */
	f.frame.planes[0].bytes = bytes;
	for (size_t i = 0; i < bytes; i++) {
		int err;

		jpeg[i] ^= 0x40;
		err = frame_decode(f.decoder, &f.frame, &f.canvas, NULL);
		expect_that(err == 0 || err == -EBADMSG, "byte %zu of the JPEG damaged: %d", i,
			    err);
		jpeg[i] ^= 0x40;
	}
	if (frame_decode(f.decoder, &f.frame, &f.canvas, &fault))
		fail_msg("after damaged pictures a good one fails: %s", fault.text);
	test_frame_drop(&f);
	tjFree(jpeg);
}

/* Some webcams send stray bytes in every picture; the picture is complete all the same. */
TEST("stray bytes before the end are forgiven")
{
	uint8_t rgb[64 * 48 * 3], *jpeg, *longer;
	struct fixture f;
	size_t bytes;

	make_jpeg_frame(&f, TJSAMP_420, rgb, &jpeg);
	bytes = f.frame.planes[0].bytes;
	longer = malloc(bytes + 6);
	memcpy(longer, jpeg, bytes - 2);
	memcpy(longer + bytes - 2, "stray!\xff\xd9", 8);
	f.frame.planes[0] = (struct frame_plane){longer, 0, bytes + 6};
	assert_int_equal(frame_decode(f.decoder, &f.frame, &f.canvas, NULL), 0);
	free(longer);
	test_frame_drop(&f);
	tjFree(jpeg);
}

TEST("jpeg of another size is refused")
{
	uint8_t rgb[64 * 48 * 3], *jpeg;
	struct fault fault = {""};
	struct fixture f;

	make_jpeg_frame(&f, TJSAMP_420, rgb, &jpeg);
	canvas_free(&f.canvas);
	assert_int_equal(canvas_create(&f.canvas, 32, 48), 0);
	f.frame.width = 32;
	assert_int_equal(frame_decode(f.decoder, &f.frame, &f.canvas, &fault), -EBADMSG);
	assert_non_null(strstr(fault.text, "64x48"));
	test_frame_drop(&f);
	tjFree(jpeg);
}

TEST("canvases")
{
	struct canvas canvas;

	assert_int_equal(canvas_create(&canvas, 0, 4), -EINVAL);
	assert_int_equal(canvas_create(&canvas, 4, 40000), -EINVAL);
	assert_null(canvas.pixels);
	assert_int_equal(canvas_create(&canvas, 17, 3), 0);
	assert_int_equal(canvas.stride % 64, 0);
	assert_int_equal((uintptr_t)canvas.pixels % 64, 0);
	assert_int_equal(canvas.pixels[3], 255);
	canvas_free(&canvas);
	canvas_free(&canvas);
}
