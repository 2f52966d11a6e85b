/* SPDX-License-Identifier: MIT */
/* Pictures of textures in the kinds that programs for 3D objects write. */
#include <errno.h>
#include <math.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <tiffio.h>

#include "bake/base/picture_file.h"
#include "tests/support/bake/small_scene.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

static void write_bytes(const char *name, const uint8_t *bytes, size_t count)
{
	FILE *stream = fopen(small_scene_path(name), "wb");

	assert_non_null(stream);
	assert_int_equal(fwrite(bytes, 1, count, stream), count);
	fclose(stream);
}

static void read_fine(const char *name, struct image *image)
{
	struct fault fault = {.text = ""};

	if (picture_file_read(small_scene_path(name), image, &fault) < 0)
		fail_msg("%s", fault.text);
}

/* Two pixels, red and half green. */
static void expect_pair(const char *name, bool alpha)
{
	static const uint8_t expected[6] = {255, 0, 0, 0, 128, 0};
	struct image image;

	read_fine(name, &image);
	assert_int_equal(image.width, 2);
	assert_int_equal(image.height, 1);
	assert_memory_equal(image.u8, expected, sizeof(expected));
	assert_int_equal(image.alpha != NULL, alpha);
	if (alpha)
		assert_int_equal(image.alpha[1], 51);
	image_free(&image);
}

/* Each file cut anywhere is read or refused in a sentence. */
static void cut_anywhere(const char *name, const uint8_t *bytes, size_t count)
{
	for (size_t cut = 0; cut < count; cut++) {
		struct fault fault = {.text = ""};
		struct image image;

		write_bytes(name, bytes, cut);
		if (picture_file_read(small_scene_path(name), &image, &fault) < 0)
			assert_non_null(strstr(fault.text, name));
		image_free(&image);
	}
}

TEST("bmp and tga")
{
	static const uint8_t bmp[] = {'B', 'M', 62, 0, 0, 0, 0, 0, 0,	0, 54,	0, 0,  0, 40, 0,
				      0,   0,	2,  0, 0, 0, 1, 0, 0,	0, 1,	0, 24, 0, 0,  0,
				      0,   0,	8,  0, 0, 0, 0, 0, 0,	0, 0,	0, 0,  0, 0,  0,
				      0,   0,	0,  0, 0, 0, 0, 0, 255, 0, 128, 0, 0,  0};
	/* run-length coded, blue first, rows from below */
	static const uint8_t tga[] = {0, 0, 10, 0, 0, 0, 0, 0,	 0,   0,    0, 0,   2, 0,
				      1, 0, 32, 8, 0, 0, 0, 255, 255, 0x80, 0, 128, 0, 51};
	static const uint8_t from_right[] = {0, 0, 2, 0, 0,  0,	   0, 0,   0, 0, 0, 0,
					     2, 0, 1, 0, 24, 0x10, 0, 128, 0, 0, 0, 255};
	uint8_t top[sizeof(bmp)];
	struct fault fault = {.text = ""};
	struct image image;

	write_bytes("pair.bmp", bmp, sizeof(bmp));
	expect_pair("pair.bmp", false);
	write_bytes("pair.TGA", tga, sizeof(tga));
	expect_pair("pair.TGA", true);
	write_bytes("pair.TGA", from_right, sizeof(from_right));
	assert_int_equal(picture_file_read(small_scene_path("pair.TGA"), &image, &fault), -EBADMSG);
	assert_non_null(strstr(fault.text, "expected one from the left"));
	/* the same from the top */
	memcpy(top, bmp, sizeof(top));
	memset(top + 22, 255, 4);
	write_bytes("pair.bmp", top, sizeof(top));
	expect_pair("pair.bmp", false);
	cut_anywhere("cut.bmp", bmp, sizeof(bmp));
	cut_anywhere("cut.tga", tga, sizeof(tga));
}

static void write_tiff(const char *name, int bits, int samples, const void *row)
{
	TIFF *tiff = TIFFOpen(small_scene_path(name), strstr(name, "big") ? "w8" : "w");
	const uint16_t unassociated = EXTRASAMPLE_UNASSALPHA;

	assert_non_null(tiff);
	TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, 2);
	TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, 1);
	TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, bits);
	TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, samples);
	TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 1);
	TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_LZW);
	TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC,
		     samples > 2 ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK);
	TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
	if (samples == 4)
		TIFFSetField(tiff, TIFFTAG_EXTRASAMPLES, 1, &unassociated);
	assert_int_equal(TIFFWriteScanline(tiff, (void *)row, 0, 0), 1);
	TIFFClose(tiff);
}

TEST("tiff")
{
	static const uint8_t rgb[] = {255, 0, 0, 0, 128, 0};
	static const uint8_t rgba[] = {255, 0, 0, 255, 0, 128, 0, 51};
	static const uint16_t deep[] = {65535, 1, 258, 40000, 3, 4}, grey[] = {300, 65535};
	static const uint16_t spread[] = {300, 300, 300, 65535, 65535, 65535};
	struct image image;
	uint8_t bytes[1024];
	size_t count;
	FILE *stream;

	write_tiff("rgb.tif", 8, 3, rgb);
	expect_pair("rgb.tif", false);
	write_tiff("big.tif", 8, 3, rgb);
	expect_pair("big.tif", false);
	write_tiff("rgba.tiff", 8, 4, rgba);
	read_fine("rgba.tiff", &image);
	assert_int_equal(image.alpha[1], 51);
	/* within what premultiplying by 51 leaves */
	expect_below(abs(image.u8[4] - 128), 4, "%d", image.u8[4]);
	image_free(&image);
	write_tiff("deep.tif", 16, 3, deep);
	read_fine("deep.tif", &image);
	assert_memory_equal(image.u16, deep, sizeof(deep));
	image_free(&image);
	write_tiff("grey.tif", 16, 1, grey);
	read_fine("grey.tif", &image);
	assert_memory_equal(image.u16, spread, sizeof(spread));
	image_free(&image);
	stream = fopen(small_scene_path("deep.tif"), "rb");
	assert_non_null(stream);
	count = fread(bytes, 1, sizeof(bytes), stream);
	fclose(stream);
	cut_anywhere("cut.tif", bytes, count);
}

struct tiff_case {
	int width, height, bits, samples, format, turned, extra; /* extra -1: not said */
	const void *pixels;
};

static void write_tiff_of(const char *name, const struct tiff_case *of)
{
	TIFF *tiff = TIFFOpen(small_scene_path(name), "w");
	const uint16_t extra = (uint16_t)of->extra;
	const size_t row = (size_t)(of->width * of->samples * of->bits / 8);

	assert_non_null(tiff);
	TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, of->width);
	TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, of->height);
	TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, of->bits);
	TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, of->samples);
	TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, of->format);
	TIFFSetField(tiff, TIFFTAG_ORIENTATION, of->turned);
	TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, of->height);
	TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC,
		     of->samples > 2 ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK);
	TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
	if (of->extra >= 0)
		TIFFSetField(tiff, TIFFTAG_EXTRASAMPLES, 1, &extra);
	for (int y = 0; y < of->height; y++)
		assert_int_equal(TIFFWriteScanline(tiff, (char *)of->pixels + (size_t)y * row,
						   (uint32_t)y, 0),
				 1);
	TIFFClose(tiff);
}

/* Floats of both sizes are linear light. */
TEST("tiff floats")
{
	static const uint16_t halves[] = {0x3c00, 0x3400, 0, 0x4000, 0x0001, 0xb800};
	static const float singles[] = {1, 0.5f, 0, 0.25f, 0.125f, 0, -1, 1}, odd[] = {NAN};
	static const float opaque[] = {1, 0.5f, 0, 1, 0.125f, 0, 1, 1};
	static const float expected[2][6] = {{1, 0.25f, 0, 2, 5.9604645e-8f, 0},
					     {2, 1, 0, 0.125f, 0, 1}};
	const struct tiff_case cases[] = {
		{2, 1, 16, 3, SAMPLEFORMAT_IEEEFP, 1, -1, halves},
		{2, 1, 32, 4, SAMPLEFORMAT_IEEEFP, 1, EXTRASAMPLE_ASSOCALPHA,
		 (float[]){1, 0.5f, 0, 0.5f, 0.125f, -3, 1, 1}},
		{2, 1, 32, 4, SAMPLEFORMAT_IEEEFP, 1, EXTRASAMPLE_UNSPECIFIED, singles},
		{2, 1, 32, 4, SAMPLEFORMAT_IEEEFP, 1, EXTRASAMPLE_UNASSALPHA, opaque},
		{1, 1, 32, 1, SAMPLEFORMAT_IEEEFP, 1, -1, odd},
		{2, 1, 16, 3, SAMPLEFORMAT_INT, 1, -1, halves}};
	struct fault fault = {.text = ""};
	struct image image;

	for (int k = 0; k < 2; k++) {
		write_tiff_of("f.tif", &cases[k]);
		read_fine("f.tif", &image);
		assert_non_null(image.f32);
		for (int i = 0; i < 6; i++)
			expect_below(fabsf(image.f32[i] - expected[k][i]), 1e-12f, "k=%d, i=%d", k,
				     i);
		assert_int_equal(image.alpha != NULL, k == 1);
		if (k == 1)
			assert_int_equal(image.alpha[0], 128);
		image_free(&image);
	}
	/* of a further sample that is none, and of alpha that is full everywhere */
	for (int k = 2; k < 4; k++) {
		write_tiff_of("f.tif", &cases[k]);
		read_fine("f.tif", &image);
		expect_that(!image.alpha, "k=%d", k);
		assert_true(image.f32[0] == 1 && image.f32[3] == 0.125f &&
			    image.f32[5] == (k == 2 ? 0 : 1));
		image_free(&image);
	}
	write_tiff_of("f.tif", &cases[4]);
	assert_int_equal(picture_file_read(small_scene_path("f.tif"), &image, &fault), -EDOM);
	assert_non_null(strstr(fault.text, "f.tif: row 0 has light that is not finite"));
	write_tiff_of("f.tif", &cases[5]);
	assert_int_equal(picture_file_read(small_scene_path("f.tif"), &image, &fault), -EBADMSG);
	assert_non_null(strstr(fault.text, "f.tif: a TIFF of signed or complex numbers"));
}

/* A fourth sample that is no alpha counts for nothing, in 8 and 16 bits. */
TEST("tiff further samples")
{
	static const uint8_t bytes[] = {255, 0, 0, 0, 0, 128, 0, 51};
	static const uint16_t words[] = {65535, 1, 258, 0, 40000, 3, 4, 7};
	static const uint16_t deep[] = {65535, 1, 258, 40000, 3, 4};
	struct image image;

	for (int extra = -1; extra <= EXTRASAMPLE_UNSPECIFIED; extra++) {
		const struct tiff_case plain = {2, 1, 8, 4, SAMPLEFORMAT_UINT, 1, extra, bytes};
		const struct tiff_case fine = {2, 1, 16, 4, SAMPLEFORMAT_UINT, 1, extra, words};

		write_tiff_of("extra.tif", &plain);
		expect_pair("extra.tif", false);
		write_tiff_of("extra.tif", &fine);
		read_fine("extra.tif", &image);
		assert_memory_equal(image.u16, deep, sizeof(deep));
		assert_null(image.alpha);
		image_free(&image);
	}
}

TEST("tiff to be turned")
{
	const struct tiff_case of = {3,	 2,	  8, 1, SAMPLEFORMAT_UINT, ORIENTATION_BOTRIGHT,
				     -1, "abcdef"};
	struct fault fault = {.text = ""};
	struct image image;

	write_tiff_of("turned.tif", &of);
	assert_int_equal(picture_file_read(small_scene_path("turned.tif"), &image, &fault),
			 -EBADMSG);
	assert_non_null(strstr(fault.text,
			       "turned.tif: a TIFF that is to be turned (its orientation is 3)"));
}

static void write_deep_png(const char *name, int kind, const uint8_t *row)
{
	png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
	png_infop info = png_create_info_struct(png);
	FILE *stream = fopen(small_scene_path(name), "wb");

	assert_non_null(stream);
	if (setjmp(png_jmpbuf(png)))
		fail_msg("libpng cannot write");
	png_init_io(png, stream);
	png_set_IHDR(png, info, 2, 1, 16, kind, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
		     PNG_FILTER_TYPE_DEFAULT);
	png_write_info(png, info);
	png_write_row(png, row);
	png_write_end(png, info);
	png_destroy_write_struct(&png, &info);
	fclose(stream);
}

/* All 16 bits reach the float values: two code values that 8 bits would make one. */
TEST("deep png")
{
	static const uint8_t grey[] = {0x01, 0x00, 0x01, 0x20};
	static const uint8_t rgba[] = {0, 1, 0, 2, 0, 3, 255, 255, 0, 4, 0, 5, 0, 6, 51, 51};
	static const uint16_t expected[] = {1, 2, 3, 4, 5, 6};
	struct image image;

	write_deep_png("grey.png", PNG_COLOR_TYPE_GRAY, grey);
	read_fine("grey.png", &image);
	assert_non_null(image.u16);
	assert_int_equal(picture_file_decode(&image, true), 0);
	assert_null(image.u16);
	expect_below(fabsf(image.f32[0] - 256 / 65535.0f), 1e-9f, "%d", 0);
	expect_below(fabsf(image.f32[5] - 288 / 65535.0f), 1e-9f, "%d", 5);
	image_free(&image);
	read_fine("grey.png", &image);
	assert_int_equal(picture_file_decode(&image, false), 0);
	expect_below(fabsf(image.f32[0] - 256 / 65535.0f / 12.92f), 1e-9f, "%d", 0);
	image_free(&image);
	write_deep_png("alpha.png", PNG_COLOR_TYPE_RGBA, rgba);
	read_fine("alpha.png", &image);
	assert_memory_equal(image.u16, expected, sizeof(expected));
	assert_int_equal(image.alpha[0], 255);
	assert_int_equal(image.alpha[1], 51);
	image_free(&image);
}

TEST_GROUP(small_scene_begin, small_scene_end);
