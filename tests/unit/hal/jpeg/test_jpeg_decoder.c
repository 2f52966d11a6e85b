/* SPDX-License-Identifier: MIT */
/* JPEG pictures as cameras and programs write them: which oddities are forgiven, and which damage
 * is seen. */
#include <stdbool.h>

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <jpeglib.h>

#include "hal/jpeg/jpeg_decoder.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

enum { WIDTH = 80, HEIGHT = 64, ROOM = 1 << 16 };

/* How a picture is written. */
struct written {
	J_COLOR_SPACE space; /* of the pixels that the encoder gets */
	bool progressive;
	int restart_rows;
};

static const struct written baseline = {.space = JCS_RGB};

/* Pixel (x, y) in R'G'B': soft colours, with a texture that each block has to carry. */
static void paint(int x, int y, uint8_t rgb[3])
{
	rgb[0] = (uint8_t)(60 + x + (x * 7 + y * 13) % 32);
	rgb[1] = (uint8_t)(200 - y - (x * 5 + y * 3) % 32);
	rgb[2] = (uint8_t)(90 + (x * 11 + y * 17) % 48);
}

static size_t write_jpeg(const struct written *how, uint8_t bytes[ROOM])
{
	struct jpeg_compress_struct info = {.err = NULL};
	struct jpeg_error_mgr errors;
	unsigned char *out = NULL;
	unsigned long length = 0;

	info.err = jpeg_std_error(&errors);
	jpeg_create_compress(&info);
	jpeg_mem_dest(&info, &out, &length);
	info.image_width = WIDTH;
	info.image_height = HEIGHT;
	info.input_components = how->space == JCS_CMYK ? 4 : 3;
	info.in_color_space = how->space;
	jpeg_set_defaults(&info);
	jpeg_set_quality(&info, 92, TRUE);
	if (how->progressive)
		jpeg_simple_progression(&info);
	info.restart_in_rows = how->restart_rows;
	jpeg_start_compress(&info, TRUE);
	for (int y = 0; y < HEIGHT; y++) {
		uint8_t row[4 * WIDTH], *pixels = row;

		for (int x = 0; x < WIDTH; x++) {
			uint8_t *p = row + x * info.input_components;

			paint(x, y, p);
			if (how->space == JCS_CMYK)
				p[3] = 255; /* as Adobe stores it: no black ink */
		}
		jpeg_write_scanlines(&info, &pixels, 1);
	}
	jpeg_finish_compress(&info);
	jpeg_destroy_compress(&info);
	assert_in_range(length, 100, ROOM);
	memcpy(bytes, out, length);
	free(out);
	return length;
}

/* Decodes, and returns the error. pixels: R'G'B'. */
static int decode(struct jpeg_decoder *jpeg, const uint8_t *data, size_t bytes,
		  uint8_t pixels[HEIGHT * WIDTH * 3], struct fault *fault)
{
	int width, height, err;

	err = jpeg_decoder_open(jpeg, data, bytes, &width, &height, fault);
	if (err)
		return err;
	assert_int_equal(width, WIDTH);
	assert_int_equal(height, HEIGHT);
	return jpeg_decoder_read(jpeg, JPEG_RGB, pixels, (size_t)WIDTH * 3, WIDTH, HEIGHT, fault);
}

static void expect_painted(const uint8_t *pixels, int most, const char *what)
{
	double sum = 0;

	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			uint8_t rgb[3];

			paint(x, y, rgb);
			for (int c = 0; c < 3; c++)
				sum += abs(pixels[3 * (y * WIDTH + x) + c] - rgb[c]);
		}
	expect_at_most((int)(sum / (HEIGHT * WIDTH * 3)), most, "%s: mean error in levels", what);
}

/* Offset of the last marker of a kind. */
static size_t last_marker(const uint8_t *data, size_t bytes, uint8_t marker)
{
	for (size_t i = bytes - 2; i > 0; i--)
		if (data[i] == 0xff && data[i + 1] == marker)
			return i;
	fail_msg("no marker %02x", marker);
	return 0;
}

/* Copies a picture with extra bytes at a place. */
static size_t with_bytes(const uint8_t *from, size_t bytes, size_t at, const void *extra,
			 size_t count, uint8_t *to)
{
	memcpy(to, from, at);
	memcpy(to + at, extra, count);
	memcpy(to + at + count, from + at, bytes - at);
	return bytes + count;
}

TEST("oddities are forgiven")
{
	static uint8_t whole[ROOM], odd[2 * ROOM], pixels[HEIGHT * WIDTH * 3], filler[512];
	struct written progressive = {.space = JCS_RGB, .progressive = true};
	struct jpeg_decoder *jpeg = *state;
	size_t bytes = write_jpeg(&baseline, whole), scan = last_marker(whole, bytes, 0xda), n;

	memset(filler, 0xff, sizeof(filler));
#define SHOWN(data, count, what)                                                                   \
	do {                                                                                       \
		struct fault fault = {""};                                                         \
                                                                                                   \
		expect_equal(decode(jpeg, data, count, pixels, &fault), 0, "%s: %s", what,         \
			     fault.text);                                                          \
		expect_painted(pixels, 8, what);                                                   \
	} while (0)
	SHOWN(whole, bytes, "as it should be");
	SHOWN(whole, bytes - 2, "no end marker");
	n = with_bytes(whole, bytes, bytes, "\0\0\0\0\0\0\0\0", 8, odd);
	SHOWN(odd, n, "padded with zeros");
	n = with_bytes(whole, bytes, bytes, filler, sizeof(filler), odd);
	SHOWN(odd, n, "512 bytes of ff behind it");
	n = with_bytes(whole, bytes, bytes, whole + bytes / 2, bytes - bytes / 2, odd);
	SHOWN(odd, n, "the tail of an older picture behind it");
	n = with_bytes(whole, bytes, 0, "stray", 5, odd);
	SHOWN(odd, n, "stray bytes before it");
	n = with_bytes(whole, bytes, bytes - 2, "stray!", 6, odd);
	SHOWN(odd, n, "stray bytes before its end");
	n = with_bytes(whole, bytes, scan, "\xff\xff\xff", 3, odd);
	SHOWN(odd, n, "padded markers");
	n = with_bytes(whole, bytes, bytes, "\xff\xd9", 2, odd);
	SHOWN(odd, n, "two end markers");
	memcpy(odd, whole, bytes);
	odd[scan + 2 + 8 + 1] = 0; /* Se, the last coefficient, which is 63 in baseline pictures */
	SHOWN(odd, bytes, "Se = 0");
	bytes = write_jpeg(&progressive, whole);
	SHOWN(whole, bytes, "progressive");
	SHOWN(whole, bytes - 2, "progressive without an end marker");
}

static void expect_damaged(struct jpeg_decoder *jpeg, const uint8_t *data, size_t bytes,
			   const char *what)
{
	static uint8_t pixels[HEIGHT * WIDTH * 3];
	struct fault fault = {""};

	expect_equal(decode(jpeg, data, bytes, pixels, &fault), -EBADMSG, "%s", what);
	expect_above(strlen(fault.text), 20, "%s", what);
}

TEST("damage is seen")
{
	static uint8_t whole[ROOM], odd[2 * ROOM], pixels[HEIGHT * WIDTH * 3];
	struct written progressive = {.space = JCS_RGB, .progressive = true};
	struct written restarts = {.space = JCS_RGB, .restart_rows = 1};
	struct jpeg_decoder *jpeg = *state;
	size_t bytes = write_jpeg(&baseline, whole), cut = bytes * 3 / 4, at;
	struct fault fault = {""};

	expect_damaged(jpeg, whole, 0, "nothing");
	expect_damaged(jpeg, (const uint8_t *)"rubbish, rubbish", 16, "rubbish");
	for (size_t c = 2; c < bytes - 8; c += 17)
		expect_damaged(jpeg, whole, c, "cut off");
	memcpy(odd, whole, cut);
	memcpy(odd + cut, "\xff\xd9", 2);
	expect_damaged(jpeg, odd, cut + 2, "a part is missing, and it has an end marker");
	/* The last warning of this one, stray bytes, is harmless. */
	at = with_bytes(odd, cut + 2, cut, "\xff\xc4stray", 7, odd + ROOM);
	expect_damaged(jpeg, odd + ROOM, at, "a part is missing, and stray bytes follow");
	bytes = write_jpeg(&restarts, whole);
	at = last_marker(whole, bytes, 0xd0);
	memcpy(odd, whole, at - 40);
	memcpy(odd + at - 40, whole + at, bytes - at);
	expect_damaged(jpeg, odd, bytes - 40, "a part is missing before a restart marker");
	bytes = write_jpeg(&progressive, whole);
	expect_damaged(jpeg, whole, last_marker(whole, bytes, 0xda), "a scan is missing");
	bytes = write_jpeg(&baseline, whole);
	expect_equal(decode(jpeg, whole, bytes, pixels, &fault), 0, "a good one after it: %s",
		     fault.text);
}

/* Adobe's programs store CMYK inverted; libjpeg writes their marker with it. */
TEST("cmyk becomes rgb")
{
	static uint8_t bytes[ROOM], pixels[HEIGHT * WIDTH * 3];
	const struct written cmyk = {.space = JCS_CMYK};
	const size_t length = write_jpeg(&cmyk, bytes);

	expect_equal(decode(*state, bytes, length, pixels, NULL), 0, "CMYK");
	expect_painted(pixels, 8, "CMYK");
}

/* Pictures are cut to what is wanted; the bytes beside it stay. */
TEST("a part is read")
{
	static uint8_t bytes[ROOM], whole[HEIGHT * WIDTH * 3], part[50 * 256];
	const size_t length = write_jpeg(&baseline, bytes);
	int width, height;

	memset(part, 7, sizeof(part));
	assert_int_equal(decode(*state, bytes, length, whole, NULL), 0);
	assert_int_equal(jpeg_decoder_open(*state, bytes, length, &width, &height, NULL), 0);
	assert_int_equal(jpeg_decoder_read(*state, JPEG_BGRX, part, 256, 60, 50, NULL), 0);
	for (int y = 0; y < 50; y++)
		for (int x = 0; x < 64; x++) {
			const uint8_t *got = part + y * 256 + x * 4,
				      *rgb = whole + 3 * (y * WIDTH + x);

			for (int c = 0; c < 3; c++)
				expect_equal(got[2 - c], x < 60 ? rgb[c] : 7, "%d, %d, %d", x, y,
					     c);
			expect_equal(got[3], x < 60 ? 255 : 7, "%d, %d", x, y);
		}
	assert_int_equal(jpeg_decoder_open(*state, bytes, length, &width, &height, NULL), 0);
	assert_int_equal(jpeg_decoder_read(*state, JPEG_BGRX, part, 256, WIDTH + 1, 1, NULL),
			 -EBADMSG);
}

static int test_jpeg_begin(void **state)
{
	struct jpeg_decoder *jpeg;
	int err = jpeg_decoder_create(&jpeg);

	*state = jpeg;
	return err;
}

static int test_jpeg_end(void **state)
{
	jpeg_decoder_destroy(*state);
	jpeg_decoder_destroy(NULL);
	return 0;
}

TEST_GROUP(test_jpeg_begin, test_jpeg_end);
