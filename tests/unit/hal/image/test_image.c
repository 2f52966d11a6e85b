/* SPDX-License-Identifier: MIT */
/* Picture files, against bytes assembled by hand, files that other programs wrote, and closed
 * forms; and every refusal. */
#include <errno.h>
#include <math.h>
#include <png.h>
#if WITH_WEBP
#include <webp/encode.h>
#endif
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <turbojpeg.h>
#include <unistd.h>

#include "hal/image/image.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define SAMPLES "tests/fuzz/corpus/image/"

static char folder[] = "/tmp/inlay-image-XXXXXX";

static const char *in_folder(const char *name)
{
	static char path[128];

	snprintf(path, sizeof(path), "%s/%s", folder, name);
	return path;
}

static void read_fine(const void *data, size_t bytes, struct image *image)
{
	struct fault fault = {0};
	const int err = image_read_memory(data, bytes, "memory", image, &fault);

	if (err)
		fail_msg("%d: %s", err, fault.text);
}

/* Expects an error and a word in its message. */
static void read_refused(const void *data, size_t bytes, int expected, const char *word)
{
	struct fault fault = {0};
	struct image image;
	const int err = image_read_memory(data, bytes, "memory", &image, &fault);

	if (err != expected || strncmp(fault.text, "memory: ", 8) || !strstr(fault.text, word))
		fail_msg("%d (expected %d): %s", err, expected, fault.text);
	assert_null(image.u8);
	assert_null(image.f32);
}

static void assert_pixel(const struct image *image, int x, int y, double r, double g, double b)
{
	const float *p = image->f32 + (y * image->width + x) * 3;

	if ((double)p[0] != r || (double)p[1] != g || (double)p[2] != b)
		fail_msg("(%d, %d) is %g %g %g, expected %g %g %g", x, y, (double)p[0],
			 (double)p[1], (double)p[2], r, g, b);
}

/* ---- Radiance ---- */

#define HDR_HEADER "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n"

TEST("hdr flat")
{
	/* 128 * 2^(129-136) = 1; 255 * 2^(136-136) = 255; exponent 0 is black. */
	static const char file[] = HDR_HEADER "-Y 2 +X 2\n"
					      "\x80\x40\x20\x81"
					      "\xff\x01\x00\x88"
					      "\x09\x09\x09\x00"
					      "\x80\x80\x80\x80";
	struct image image;

	read_fine(file, sizeof(file) - 1, &image);
	assert_int_equal(image.width, 2);
	assert_int_equal(image.height, 2);
	assert_null(image.u8);
	assert_pixel(&image, 0, 0, 1, 0.5, 0.25);
	assert_pixel(&image, 1, 0, 255, 1, 0);
	assert_pixel(&image, 0, 1, 0, 0, 0);
	assert_pixel(&image, 1, 1, 0.5, 0.5, 0.5);
	image_free(&image);
}

TEST("hdr exposure")
{
	static const char file[] = "#?RADIANCE\r\nEXPOSURE=2\nFORMAT=32-bit_rle_rgbe\n"
				   "COLORCORR= 1 2 4\nEXPOSURE= 0.25\n\n-Y 1 +X 1\n"
				   "\x80\x80\x80\x81";
	struct image image;

	read_fine(file, sizeof(file) - 1, &image);
	assert_pixel(&image, 0, 0, 2, 1, 0.5);
	image_free(&image);
}

/* Blanks around a value, and primaries that are nearly Radiance's own. */
TEST("hdr header words")
{
	static const char file[] =
		"#?RGBE\nFORMAT=  32-bit_rle_rgbe \n"
		"PRIMARIES= 0.640 0.330 0.290 0.600 0.150 0.060 0.333 0.333\n\n-Y 1 +X 1\n"
		"\x80\x80\x80\x81";
	static const char unsaid[] = "#?RADIANCE\nPRIMARIES=0 0 0 0 0 0 0 0\n\n-Y 1 +X 1\n"
				     "\x80\x80\x80\x81";
	static const struct {
		const char *file;
		int err;
		const char *word;
	} refused[] = {
		{"#?RADIANCE\nFORMAT=32-bit_rle_rgbex\n\n", -ENOTSUP, "expected 32-bit_rle_rgbe"},
		{"#?RADIANCE\nPRIMARIES= 0.68 0.32 0.265 0.69 0.15 0.06 0.3127 0.329\n\n", -ENOTSUP,
		 "other primaries: red 0.68 0.32"},
		{"#?RADIANCE\nPRIMARIES= 0.64 0.33\n\n", -EBADMSG,
		 "PRIMARIES and 2 numbers, expected 8"},
	};
	struct image image;

	read_fine(file, sizeof(file) - 1, &image);
	assert_pixel(&image, 0, 0, 1, 1, 1);
	image_free(&image);
	read_fine(unsaid, sizeof(unsaid) - 1, &image);
	assert_pixel(&image, 0, 0, 1, 1, 1);
	image_free(&image);
	for (size_t i = 0; i < sizeof(refused) / sizeof(*refused); i++)
		read_refused(refused[i].file, strlen(refused[i].file), refused[i].err,
			     refused[i].word);
}

/* A 2 x 3 picture, numbered in reading order, stored in each of the eight orientations. */
TEST("hdr orientations")
{
	static const struct {
		const char *line, *order;
	} ways[] = {
		{"-Y 3 +X 2", "123456"}, {"-Y 3 -X 2", "214365"}, {"+Y 3 +X 2", "563412"},
		{"+Y 3 -X 2", "654321"}, {"+X 2 -Y 3", "135246"}, {"+X 2 +Y 3", "531642"},
		{"-X 2 -Y 3", "246135"}, {"-X 2 +Y 3", "642531"},
	};

	for (size_t i = 0; i < sizeof(ways) / sizeof(ways[0]); i++) {
		char file[128];
		struct image image;
		int length = snprintf(file, sizeof(file), HDR_HEADER "%s\n", ways[i].line);

		for (int k = 0; k < 6; k++) {
			memset(file + length, (ways[i].order[k] - '0') * 16, 3);
			file[length + 3] = (char)136;
			length += 4;
		}
		read_fine(file, (size_t)length, &image);
		expect_equal(image.width, 2, "i=%zu", i);
		expect_equal(image.height, 3, "i=%zu", i);
		for (int k = 0; k < 6; k++)
			assert_pixel(&image, k % 2, k / 2, 16 * (k + 1), 16 * (k + 1),
				     16 * (k + 1));
		image_free(&image);
	}
}

TEST("hdr new coding")
{
	static const char file[] = HDR_HEADER "-Y 1 +X 8\n"
					      "\x02\x02\x00\x08"
					      "\x88\x80" /* red: 8 x 128 */
					      "\x08\x01\x02\x03\x04\x05\x06\x07\x08" /* green */
					      "\x83\x10\x02\x20\x21\x83\x30"	     /* blue */
					      "\x88\x88";			     /* 2^0 */
	static const double blue[8] = {16, 16, 16, 32, 33, 48, 48, 48};
	struct image image;

	read_fine(file, sizeof(file) - 1, &image);
	for (int x = 0; x < 8; x++)
		assert_pixel(&image, x, 0, 128, x + 1, blue[x]);
	image_free(&image);
}

TEST("hdr old coding")
{
	/* One pixel, 43 copies, then 1 << 8 copies: 300 in all. */
	static const char file[] = HDR_HEADER "-Y 1 +X 300\n"
					      "\x0a\x14\x1e\x88"
					      "\x01\x01\x01\x2b"
					      "\x01\x01\x01\x01";
	struct image image;

	read_fine(file, sizeof(file) - 1, &image);
	for (int x = 0; x < 300; x++)
		assert_pixel(&image, x, 0, 10, 20, 30);
	image_free(&image);
}

TEST("hdr refusals")
{
	static const struct {
		const char *text;
		size_t bytes;
		int err;
		const char *word;
	} cases[] = {
#define CASE(text, err, word) {text, sizeof(text) - 1, err, word}
		CASE("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n\x80\x80\x80\x80", -ENOTSUP,
		     "32-bit_rle_xyze"),
		CASE("#?RADIANCE\nEXPOSURE=nan\n\n-Y 1 +X 1\n\x80\x80\x80\x80", -EBADMSG,
		     "EXPOSURE=nan"),
		CASE("#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 1\n\x80\x80\x80\x80", -EBADMSG, "above 0"),
		CASE("#?RADIANCE\n", -EBADMSG, "no end"),
		CASE(HDR_HEADER "-Y 1 +Y 1\n\x80\x80\x80\x80", -EBADMSG, "-Y 512 +X 1024"),
		CASE(HDR_HEADER "-Y 0 +X 1\n\x80\x80\x80\x80", -EBADMSG, "1 x 0"),
		CASE(HDR_HEADER "-Y 40000 +X 1\n\x80\x80\x80\x80", -EFBIG, "32768"),
		CASE(HDR_HEADER "-Y 30000 +X 30000\n\x80\x80\x80\x80", -EFBIG, "of memory"),
		CASE(HDR_HEADER "-Y 1 +X 2\n\x80\x80\x80\x80", -EBADMSG, "row 1 of 1"),
		CASE(HDR_HEADER "-Y 1 +X 2\n\x01\x01\x01\x02", -EBADMSG, "row 1 of 1"),
		CASE(HDR_HEADER "-Y 1 +X 2\n\x80\x80\x80\x80\x01\x01\x01\x09", -EBADMSG, "row 1"),
		CASE(HDR_HEADER "-Y 1 +X 8\n\x02\x02\x00\x09\x88\x80", -EBADMSG, "row 1 of 1"),
		CASE(HDR_HEADER "-Y 1 +X 8\n\x02\x02\x00\x08\x89\x80", -EBADMSG, "row 1 of 1"),
		CASE(HDR_HEADER "-Y 1 +X 8\n\x02\x02\x00\x08\x00\x80", -EBADMSG, "row 1 of 1"),
#undef CASE
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++)
		read_refused(cases[i].text, cases[i].bytes, cases[i].err, cases[i].word);
}

/* Written and read again: the error is at most half a step of a mantissa of 127.75 or more. */
TEST("hdr round trip")
{
	static const int widths[] = {1, 7, 8, 127, 128, 129, 300};
	struct chance chance = chance_begin("hdr");

	for (size_t i = 0; i < sizeof(widths) / sizeof(widths[0]); i++) {
		struct image out, in;
		struct fault fault;
		const int count = widths[i] * 5;

		assert_int_equal(image_create_f32(&out, widths[i], 5), 0);
		for (int p = 0; p < count * 3; p++)
			out.f32[p] = p / 3 % 4 == 0   ? 0.75f
				     : p / 3 % 4 == 1 ? 0
						      : ldexpf((float)chance_real(&chance, 0, 1),
							       chance_int(&chance, -30, 29));
		out.f32[0] = 3e38f;
		out.f32[1] = 1e-37f;
		out.f32[2] = 2e38f;
		assert_int_equal(image_write(in_folder("x.hdr"), &out, &fault), 0);
		assert_int_equal(image_read(in_folder("x.hdr"), &in, &fault), 0);
		expect_equal(in.width, widths[i], "i=%zu", i);
		expect_equal(in.height, 5, "i=%zu", i);
		/* The largest RGBE value is 255 * 2^119. */
		expect_below(fabsf(in.f32[0] - 255 * 0x1p119f), 1e30f, "i=%zu", i);
		for (int p = 1; p < count; p++) {
			const float *a = out.f32 + 3 * p, *b = in.f32 + 3 * p;
			const float peak = fmaxf(a[0], fmaxf(a[1], a[2]));

			for (int c = 0; c < 3; c++)
				expect_at_most(fabsf(a[c] - b[c]), peak / 255.5f,
					       "i=%zu, p=%d, c=%d", i, p, c);
		}
		image_free(&out);
		image_free(&in);
	}
}

/* Means and one pixel as an independent decoder reads them (RGBE bytes times 2^(e-136)). */
TEST("hdr real")
{
	static const struct {
		const char *name;
		double mean[3], upper[3];
		float pixel[3]; /* pixel (700, 100) */
	} truth[] = {
		{"st_fagans_interior_1k.hdr",
		 {0.9116973353084177, 0.7051612892537378, 0.43892477761255577},
		 {1.104800732806325, 0.9446641132235527, 0.6846048105508089},
		 {166 / 256.0f, 116 / 256.0f, 74 / 256.0f}},
		{"studio_small_03_1k.hdr",
		 {1.6359547391894012, 1.8823256665782537, 2.127458982051394},
		 {2.793975810189295, 3.210623204591684, 3.645626455971069},
		 {109 / 16384.0f, 132 / 16384.0f, 147 / 16384.0f}},
		{"venice_sunset_1k.hdr",
		 {0.40465654894615, 0.41623819593041844, 0.573428713121757},
		 {0.6440945899812505, 0.6830570940219332, 0.9887893334671389},
		 {63 / 128.0f, 84 / 128.0f, 143 / 128.0f}},
	};
	const char *shared = getenv("INLAY_SHARED_DATA");

	for (int i = 0; i < 3; i++) {
		char path[512];
		struct fault fault;
		struct image image;
		int err;

		snprintf(path, sizeof(path), "%s/hdri/%s", shared ? shared : "../shared/data",
			 truth[i].name);
		err = image_read(path, &image, &fault);
		if (err == -ENOENT) {
			print_message("%s is missing\n", path);
			skip();
		}
		expect_equal(err, 0, "i=%d", i);
		expect_equal(image.width, 1024, "i=%d", i);
		expect_equal(image.height, 512, "i=%d", i);
		for (int c = 0; c < 3; c++) {
			double upper = 0, lower = 0;

			for (int p = 0; p < 1024 * 512; p++)
				*(p < 1024 * 256 ? &upper : &lower) += (double)image.f32[3 * p + c];
			expect_below(fabs((upper + lower) / (1024 * 512) - truth[i].mean[c]), 1e-9,
				     "i=%d, c=%d", i, c);
			expect_below(fabs(upper / (1024 * 256) - truth[i].upper[c]), 1e-9,
				     "i=%d, c=%d", i, c);
		}
		assert_memory_equal(image.f32 + (100 * 1024 + 700) * 3, truth[i].pixel, 12);
		image_free(&image);
	}
}

/* ---- PFM ---- */

TEST("pfm by hand")
{
	/* Rows are stored from the bottom up. 1 is 3f800000, 2 is 40000000, 0.5 is 3f000000. */
	static const char little[] = "PF\n1 2\n-1.0\n"
				     "\0\0\x80\x3f\0\0\0\x40\0\0\0\x3f"
				     "\0\0\0\0\0\0\0\x3f\0\0\x80\x3f";
	static const char big[] = "PF 1 2 1\n"
				  "\x3f\x80\0\0\x40\0\0\0\x3f\0\0\0"
				  "\0\0\0\0\x3f\0\0\0\x3f\x80\0\0";
	static const char grey[] = "Pf\n2 1\n-0.5\n\0\0\x80\x3f\0\0\0\x40";
	static const char returns[] = "Pf\r\n2 1\r\n-0.5\r\n\0\0\x80\x3f\0\0\0\x40";
	struct image image;

	read_fine(little, sizeof(little) - 1, &image);
	assert_pixel(&image, 0, 1, 1, 2, 0.5);
	assert_pixel(&image, 0, 0, 0, 0.5, 1);
	image_free(&image);
	read_fine(big, sizeof(big) - 1, &image);
	assert_pixel(&image, 0, 1, 1, 2, 0.5);
	assert_pixel(&image, 0, 0, 0, 0.5, 1);
	image_free(&image);
	read_fine(grey, sizeof(grey) - 1, &image);
	assert_int_equal(image.width, 2);
	assert_pixel(&image, 0, 0, 1, 1, 1);
	assert_pixel(&image, 1, 0, 2, 2, 2);
	image_free(&image);
	read_fine(returns, sizeof(returns) - 1, &image);
	assert_pixel(&image, 0, 0, 1, 1, 1);
	assert_pixel(&image, 1, 0, 2, 2, 2);
	image_free(&image);
}

TEST("pfm round trip")
{
	static const char start[] = "PF\n3 2\n-1.0\n";
	const float samples[18] = {0,	 1,	 2,  3e38f, 1e-45f, 0.1f, 6,  7,  8,
				   9.5f, 10.25f, 11, 12,    13,	    14,	  15, 16, 17};
	struct image out, in;
	struct fault fault;
	char file[128];
	FILE *stream;

	assert_int_equal(image_create_f32(&out, 3, 2), 0);
	memcpy(out.f32, samples, sizeof(samples));
	assert_int_equal(image_write(in_folder("x.pfm"), &out, &fault), 0);
	assert_int_equal(image_read(in_folder("x.pfm"), &in, &fault), 0);
	assert_memory_equal(in.f32, samples, sizeof(samples));
	/* The file: header, lower row, upper row. */
	stream = fopen(in_folder("x.pfm"), "rb");
	assert_non_null(stream);
	assert_int_equal(fread(file, 1, sizeof(file), stream), sizeof(start) - 1 + 72);
	fclose(stream);
	assert_memory_equal(file, start, sizeof(start) - 1);
	assert_memory_equal(file + sizeof(start) - 1, samples + 9, 36);
	assert_memory_equal(file + sizeof(start) - 1 + 36, samples, 36);
	image_free(&out);
	image_free(&in);
}

TEST("pfm refusals")
{
#define ONE "\0\0\x80\x3f"
#define REFUSED(text, err, word) read_refused(text, sizeof(text) - 1, err, word)
	REFUSED("PF\n1 1\n0\n" ONE ONE ONE, -EBADMSG, "scale");
	REFUSED("PF\n1 x\n1\n" ONE ONE ONE, -EBADMSG, "header");
	REFUSED("PF\n1 1\n", -EBADMSG, "header");
	REFUSED("PF\n1 2\n-1\n" ONE ONE ONE ONE ONE, -EBADMSG, "20 bytes of samples");
	REFUSED("PF\n-1 2\n-1\n" ONE, -EBADMSG, "-1 x 2");
	REFUSED("PF\n32768 32768\n-1\n" ONE, -EFBIG, "of memory");
	REFUSED("PF\n32769 1\n-1\n" ONE, -EFBIG, "32768");
	REFUSED("PF\n99999999999999 99999999999999\n-1\n" ONE, -EFBIG, "32768");
	/* Quiet NaN, infinity. */
	REFUSED("PF\n1 1\n-1\n" ONE ONE "\0\0\xc0\x7f", -EDOM, "pixel (0, 0), blue");
	REFUSED("Pf\n2 2\n-1\n" ONE ONE ONE "\0\0\x80\x7f", -EDOM, "pixel (1, 0), red");
#undef REFUSED
#undef ONE
}

/* -1, and minus zero. */
TEST("negative light is none")
{
	struct image image;

	read_fine("Pf\n2 1\n-1\n\0\0\x80\xbf\0\0\0\x80", 18, &image);
	for (int i = 0; i < 6; i++)
		expect_that(image.f32[i] == 0 && !signbit(image.f32[i]), "i=%d", i);
	image_free(&image);
}

/* ---- OpenEXR: files written by OpenEXR's C++ library ---- */

#if WITH_EXR
TEST("exr samples")
{
	static const char *const names[] = {"lines_piz.exr", "tiles_zip.exr", "lines_dwaa.exr"};

	for (int i = 0; i < 3; i++) {
		/* DWAA is lossy. */
		const double tolerance = i == 2 ? 0.02 : 0;
		struct image image;
		struct fault fault;
		char path[128];

		snprintf(path, sizeof(path), SAMPLES "%s", names[i]);
		if (image_read(path, &image, &fault))
			fail_msg("%s", fault.text);
		expect_equal(image.width, 13, "i=%d", i);
		expect_equal(image.height, 9, "i=%d", i);
		for (int y = 0; y < 9; y++)
			for (int x = 0; x < 13; x++) {
				const float *p = image.f32 + (y * 13 + x) * 3;

				expect_at_most(fabs((double)p[0] - x / 8.0), tolerance,
					       "i=%d, y=%d, x=%d", i, y, x);
				expect_at_most(fabs((double)p[1] - y / 8.0), tolerance,
					       "i=%d, y=%d, x=%d", i, y, x);
				expect_at_most(fabs((double)p[2] - (x + y) / 16.0), tolerance,
					       "i=%d, y=%d, x=%d", i, y, x);
			}
		image_free(&image);
	}
}

/* The data window: pixels from (-3, 5) on, of a picture of 20 x 20. */
TEST("exr window")
{
	struct image image;
	struct fault fault;

	assert_int_equal(image_read(SAMPLES "lines_window.exr", &image, &fault), 0);
	assert_int_equal(image.width, 20);
	assert_int_equal(image.height, 20);
	for (int y = 0; y < 20; y++)
		for (int x = 0; x < 20; x++) {
			const int u = x + 3, v = y - 5;
			const bool held = u < 13 && v >= 0 && v < 9;

			assert_pixel(&image, x, y, held ? u / 8.0 : 0, held ? v / 8.0 : 0,
				     held ? (u + v) / 16.0 : 0);
		}
	image_free(&image);
}

/* One pixel with the primaries of ACES, computed by hand. */
TEST("exr primaries")
{
	static const char file[] =
		"\x76\x2f\x31\x01\x02\0\0\0"
		"channels\0chlist\0\x13\0\0\0Y\0\x02\0\0\0\0\0\0\0\x01\0\0\0\x01\0\0\0\0"
		"chromaticities\0chromaticities\0\x20\0\0\0"
		"\x79\x23\x3c\x3f\x71\x1b\x88\x3e\0\0\0\0\0\0\x80\x3f"
		"\x17\xb7\xd1\x38\x3b\xdf\x9d\xbd\xdb\xf9\xa4\x3e\x59\x17\xad\x3e"
		"compression\0compression\0\x01\0\0\0\0"
		"dataWindow\0box2i\0\x10\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0"
		"displayWindow\0box2i\0\x10\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0"
		"lineOrder\0lineOrder\0\x01\0\0\0\0"
		"pixelAspectRatio\0float\0\x04\0\0\0\0\0\x80\x3f"
		"screenWindowCenter\0v2f\0\x08\0\0\0\0\0\0\0\0\0\0\0"
		"screenWindowWidth\0float\0\x04\0\0\0\0\0\x80\x3f\0"
		"\x5f\x01\0\0\0\0\0\0\0\0\0\0\x04\0\0\0\0\0\0\0";
	struct image image;
	struct fault fault;

	assert_int_equal(
		image_read_memory((const uint8_t *)file, sizeof(file) - 1, "aces", &image, &fault),
		-ENOTSUP);
	assert_non_null(strstr(fault.text, "other primaries: red 0.7349"));
}

/* Large enough to be compressed; DWAB is lossy. */
TEST("exr dwab")
{
	struct image image;
	struct fault fault;

	if (image_read(SAMPLES "smooth_dwab.exr", &image, &fault))
		fail_msg("%s", fault.text);
	assert_int_equal(image.width, 128);
	assert_int_equal(image.height, 96);
	for (int y = 0; y < 96; y++)
		for (int x = 0; x < 128; x++) {
			const float *p = image.f32 + (y * 128 + x) * 3;

			expect_at_most(fabs((double)p[0] - x / 64.0), 0.02, "y=%d, x=%d", y, x);
			expect_at_most(fabs((double)p[1] - y / 64.0), 0.02, "y=%d, x=%d", y, x);
			expect_at_most(fabs((double)p[2] - (x + y) / 128.0), 0.02, "y=%d, x=%d", y,
				       x);
		}
	image_free(&image);
}

TEST("exr grey")
{
	struct image image;
	struct fault fault;

	assert_int_equal(image_read(SAMPLES "grey_float.exr", &image, &fault), 0);
	for (int i = 0; i < 13 * 9; i++)
		assert_pixel(&image, i % 13, i / 13, i * 0.25, i * 0.25, i * 0.25);
	image_free(&image);
}

/* Noise does not compress and is stored as it is. Half floats of all exponents, up to 2. */
TEST("exr noise")
{
	struct image image;
	struct fault fault;

	assert_int_equal(image_read(SAMPLES "noise_zip.exr", &image, &fault), 0);
	for (unsigned i = 0; i < 13 * 9 * 3; i++) {
		uint32_t h = (i / 3 % 13) * 0x9e3779b1U ^ (i / 39) * 0x85ebca77U ^
			     (i % 3) * 0xc2b2ae3dU;
		double value;

		h ^= h >> 15;
		h *= 0x2c1b3c6dU;
		h ^= h >> 12;
		h &= 0x3fff;
		value = h >> 10 ? ldexp(1 + (h & 1023) / 1024.0, (int)(h >> 10) - 15)
				: ldexp((h & 1023) / 1024.0, -14);
		expect_equal((double)image.f32[i], value, "i=%u", i);
	}
	image_free(&image);
}

TEST("exr refusals")
{
	struct image image;
	struct fault fault;

	assert_int_equal(image_read(SAMPLES "luma_chroma.exr", &image, &fault), -ENOTSUP);
	assert_non_null(strstr(fault.text, "subsampled"));
}
#endif

/* ---- PNG and JPEG ---- */

/* Writes rows of any kind through libpng itself. */
static size_t make_png(uint8_t *out, size_t room, int width, int height, int depth, int kind,
		       bool interlaced, const uint8_t *rows, size_t stride)
{
	FILE *stream = fmemopen(out, room, "wb");
	png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
	png_infop info = png_create_info_struct(png);
	const png_color palette[] = {{10, 20, 30}, {40, 50, 60}, {70, 80, 90}};
	const png_byte alphas[] = {255, 0};
	png_bytep row[16];
	size_t bytes;

	assert_true(height <= 16 && stream);
	if (setjmp(png_jmpbuf(png)))
		fail_msg("libpng cannot write");
	png_init_io(png, stream);
	png_set_IHDR(png, info, (png_uint_32)width, (png_uint_32)height, depth, kind,
		     interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
		     PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
	if (kind == PNG_COLOR_TYPE_PALETTE) {
		png_set_PLTE(png, info, palette, 3);
		png_set_tRNS(png, info, alphas, 2, NULL);
	}
	/* A gamma chunk must not change the code values. */
	png_set_gAMA(png, info, 1.0);
	for (int y = 0; y < height; y++)
		row[y] = (png_bytep)rows + (size_t)y * stride;
	png_set_rows(png, info, row);
	png_write_png(png, info, PNG_TRANSFORM_IDENTITY, NULL);
	fflush(stream);
	bytes = (size_t)ftell(stream);
	fclose(stream);
	png_destroy_write_struct(&png, &info);
	return bytes;
}

TEST("png kinds")
{
	static const uint8_t rgb[] = {1, 2, 3, 255, 254, 253};
	static const uint8_t rgba[] = {1, 2, 3, 0, 255, 254, 253, 9};
	static const uint8_t grey[] = {7, 200};
	static const uint8_t grey_alpha[] = {7, 0, 200, 255};
	static const uint8_t bits[] = {0x40}; /* pixels 0 and 1 */
	static const uint8_t indices[] = {0, 2};
	/* v / 257, rounded: 0x0180 (384) is 1, 0x8000 is 128, 0xfeff is 254, 0xff7f is 255. */
	static const uint8_t deep[] = {0x01, 0x80, 0x80, 0,    0xfe, 0xff,
				       0xff, 0x7f, 0,	 0x80, 0,    0x81};
	static const struct {
		int depth, kind;
		const uint8_t *row;
		uint8_t expected[6];
		uint8_t alpha[2];
	} cases[] = {
		{8, PNG_COLOR_TYPE_RGB, rgb, {1, 2, 3, 255, 254, 253}, {0}},
		{8, PNG_COLOR_TYPE_RGBA, rgba, {1, 2, 3, 255, 254, 253}, {0, 9}},
		{8, PNG_COLOR_TYPE_GRAY, grey, {7, 7, 7, 200, 200, 200}, {0}},
		{8, PNG_COLOR_TYPE_GRAY_ALPHA, grey_alpha, {7, 7, 7, 200, 200, 200}, {0, 255}},
		{1, PNG_COLOR_TYPE_GRAY, bits, {0, 0, 0, 255, 255, 255}, {0}},
		{8, PNG_COLOR_TYPE_PALETTE, indices, {10, 20, 30, 70, 80, 90}, {0}},
		{16, PNG_COLOR_TYPE_RGB, deep, {1, 128, 254, 255, 0, 1}, {0}},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		uint8_t file[1024];
		struct image image;
		const size_t bytes = make_png(file, sizeof(file), 2, 1, cases[i].depth,
					      cases[i].kind, false, cases[i].row, 0);

		read_fine(file, bytes, &image);
		expect_equal(image.width, 2, "i=%zu", i);
		expect_equal(image.height, 1, "i=%zu", i);
		assert_null(image.f32);
		assert_memory_equal(image.u8, cases[i].expected, 6);
		expect_equal(!image.alpha, cases[i].alpha[1] == 0, "i=%zu", i);
		if (image.alpha)
			assert_memory_equal(image.alpha, cases[i].alpha, 2);
		image_free(&image);
	}
}

#if WITH_WEBP
/* 16383 pixels each side, with alpha, of one colour. */
TEST("webp hostile size")
{
	static const char file[] =
		"\x52\x49\x46\x46\x20\x00\x00\x00\x57\x45\x42\x50\x56\x50\x38\x4c\x14\x00\x00\x00"
		"\x2f\xfe\xbf\xff\x1f\x28\x48\x81\x0a\x51\xc0\x00\x00\x00\x00\x00\x00\x00\x00\x00";

	read_refused(file, sizeof(file) - 1, -EFBIG, "of memory");
}

TEST("webp")
{
	static const uint8_t rgba[] = {1, 2, 3, 0, 255, 254, 253, 9};
	static const uint8_t rgb[] = {1, 2, 3, 255, 254, 253};

	for (int alpha = 0; alpha < 2; alpha++) {
		struct fault fault = {.text = ""};
		struct image image;
		uint8_t *file;
		const size_t bytes = alpha ? WebPEncodeLosslessRGBA(rgba, 2, 1, 8, &file)
					   : WebPEncodeLosslessRGB(rgb, 2, 1, 6, &file);

		read_fine(file, bytes, &image);
		/* without "exact", libwebp changes colours that are wholly transparent */
		assert_memory_equal(image.u8 + 3 * alpha, rgb + 3 * alpha, alpha ? 3 : 6);
		assert_true(!image.alpha == !alpha);
		if (alpha) {
			assert_int_equal(image.alpha[0], 0);
			assert_int_equal(image.alpha[1], 9);
		}
		image_free(&image);
		for (size_t cut = 12; cut < bytes; cut += 3)
			assert_int_equal(image_read_memory(file, cut, "cut.webp", &image, &fault),
					 -EBADMSG);
		assert_non_null(strstr(fault.text, "cut.webp: damaged WebP"));
		WebPFree(file);
	}
}
#endif

TEST("png interlaced")
{
	uint8_t rows[11 * 9 * 3], file[2048];
	struct image image;
	size_t bytes;

	for (size_t i = 0; i < sizeof(rows); i++)
		rows[i] = (uint8_t)(i * 37);
	bytes = make_png(file, sizeof(file), 11, 9, 8, PNG_COLOR_TYPE_RGB, true, rows, 33);
	read_fine(file, bytes, &image);
	assert_int_equal(image.height, 9);
	assert_memory_equal(image.u8, rows, sizeof(rows));
	image_free(&image);
}

TEST("png round trip")
{
	struct image out, in;
	struct fault fault;

	assert_int_equal(image_create_u8(&out, 61, 47), 0);
	for (int i = 0; i < 61 * 47 * 3; i++)
		out.u8[i] = (uint8_t)(i * i >> 3);
	assert_int_equal(image_write(in_folder("x.PNG"), &out, &fault), 0);
	assert_int_equal(image_read(in_folder("x.PNG"), &in, &fault), 0);
	assert_int_equal(in.width, 61);
	assert_memory_equal(in.u8, out.u8, 61 * 47 * 3);
	image_free(&out);
	image_free(&in);
}

/* The header alone, with its right checksum, and an empty IDAT. */
TEST("png hostile size")
{
	static const struct {
		const char *width;
		int err;
		const char *word;
	} cases[] = {{"\0\0\x80\0", -EFBIG, "of memory"}, {"\0\x01\0\0", -EFBIG, "32768"}};

	for (int i = 0; i < 2; i++) {
		uint8_t file[64] = "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x80\0\0\0\x80\0\x08\x02";
		uint32_t crc = 0xffffffff;

		memcpy(file + 16, cases[i].width, 4);
		for (int k = 12; k < 29; k++) {
			crc ^= file[k];
			for (int bit = 0; bit < 8; bit++)
				crc = crc & 1 ? crc >> 1 ^ 0xedb88320 : crc >> 1;
		}
		png_save_uint_32(file + 29, ~crc);
		memcpy(file + 33, "\0\0\0\0IDAT\x35\xaf\x06\x1e", 12);
		read_refused(file, 45, cases[i].err, cases[i].word);
	}
}

static size_t make_jpeg(unsigned char **out, int width, int height, int subsampling)
{
	unsigned char *pixels = malloc((size_t)width * (size_t)height * 3);
	tjhandle jpeg = tjInitCompress();
	unsigned long bytes = 0;

	assert_non_null(pixels);
	/* A ramp to the right in red, downwards in green. */
	for (int i = 0; i < width * height; i++) {
		pixels[3 * i] = (unsigned char)(i % width * 255 / (width - 1));
		pixels[3 * i + 1] = (unsigned char)(i / width * 255 / (height - 1));
		pixels[3 * i + 2] = 64;
	}
	*out = NULL;
	assert_int_equal(tjCompress2(jpeg, pixels, width, 0, height, TJPF_RGB, out, &bytes,
				     subsampling, 100, TJFLAG_ACCURATEDCT),
			 0);
	tjDestroy(jpeg);
	free(pixels);
	return bytes;
}

TEST("jpeg reads")
{
	unsigned char *file;
	struct image image;
	const size_t bytes = make_jpeg(&file, 64, 48, TJSAMP_444);

	read_fine(file, bytes, &image);
	assert_int_equal(image.width, 64);
	assert_int_equal(image.height, 48);
	for (int i = 0; i < 64 * 48; i++) {
		expect_at_most(abs(image.u8[3 * i] - i % 64 * 255 / 63), 3, "i=%d", i);
		expect_at_most(abs(image.u8[3 * i + 1] - i / 64 * 255 / 47), 3, "i=%d", i);
		expect_at_most(abs(image.u8[3 * i + 2] - 64), 3, "i=%d", i);
	}
	image_free(&image);
	/* Every prefix is refused, and never read as a grey picture. */
	for (size_t cut = 3; cut + 2 < bytes; cut += 7)
		read_refused(file, cut, -EBADMSG, "JPEG");
	tjFree(file);
}

/* Four inks as Adobe's programs write them, 255 for none: black halves what the others leave. */
TEST("jpeg inks")
{
	unsigned char *file = NULL, inks[16 * 16 * 4];
	tjhandle jpeg = tjInitCompress();
	unsigned long bytes = 0;
	struct image image;

	for (int i = 0; i < 16 * 16; i++) {
		inks[4 * i] = 255;
		inks[4 * i + 1] = 128;
		inks[4 * i + 2] = 0;
		inks[4 * i + 3] = 128;
	}
	assert_int_equal(tjCompress2(jpeg, inks, 16, 0, 16, TJPF_CMYK, &file, &bytes, TJSAMP_444,
				     100, TJFLAG_ACCURATEDCT),
			 0);
	tjDestroy(jpeg);
	read_fine(file, bytes, &image);
	expect_at_most(abs(image.u8[0] - 128), 2, "%d", image.u8[0]);
	expect_at_most(abs(image.u8[1] - 64), 2, "%d", image.u8[1]);
	expect_at_most(image.u8[2], 2, "%d", image.u8[2]);
	image_free(&image);
	for (size_t cut = 3; cut + 2 < bytes; cut += 7)
		read_refused(file, cut, -EBADMSG, "JPEG");
	tjFree(file);
}

TEST("jpeg hostile size")
{
	unsigned char *file;
	const size_t bytes = make_jpeg(&file, 64, 48, TJSAMP_GRAY);
	unsigned char *frame = memmem(file, bytes, "\xff\xc0", 2);

	assert_non_null(frame);
	memcpy(frame + 5, "\x80\x00\x80\x00", 4);
	read_refused(file, bytes, -EFBIG, "of memory");
	memcpy(frame + 5, "\x90\x00\x90\x00", 4);
	read_refused(file, bytes, -EFBIG, "32768");
	tjFree(file);
}

/* ---- kinds that are not read ---- */

TEST("foreign kinds are named")
{
	static const struct {
		const char *file;
		size_t bytes;
		const char *word;
	} cases[] = {
#define CASE(text, word) {text, sizeof(text) - 1, word}
		CASE("\0\0\0\x18"
		     "ftypheic\0\0\0\0mif1heic",
		     "is HEIC"),
		CASE("\0\0\0\x18"
		     "ftypmif1\0\0\0\0mif1heic",
		     "is HEIF"),
		CASE("\0\0\0\x18"
		     "ftypavif\0\0\0\0mif1avif",
		     "is AVIF"),
		CASE("\xff\x0a\x7f\x00", "is JPEG XL"),
		CASE("\0\0\0\x0cJXL \r\n\x87\n", "is JPEG XL"),
		CASE("\0\0\0\x0cjP  \r\n\x87\n", "is JPEG 2000"),
		CASE("\xff\x4f\xff\x51\0", "is JPEG 2000"),
		CASE("DDS |\0\0\0", "is DDS"),
		CASE("\xabKTX 20\xbb\r\n\x1a\n", "is KTX2"),
		CASE("8BPS\0\1", "is PSD"),
		CASE("GIF89a", "is GIF"),
		CASE("II*\0\x08\0\0\0", "is TIFF"),
		CASE("MM\0+\0\x08\0\0", "is BigTIFF"),
		CASE("BM\0\0", "is BMP"),
		CASE("nothing", "not a picture of a known kind, expected PNG, JPEG"),
#undef CASE
	};

	for (size_t k = 0; k < sizeof(cases) / sizeof(*cases); k++)
		read_refused(cases[k].file, cases[k].bytes, -ENOTSUP, cases[k].word);
}

/* ---- all of them ---- */

static uint8_t *slurp(const char *path, size_t *bytes)
{
	FILE *stream = fopen(path, "rb");
	uint8_t *data = malloc(1 << 16);

	assert_non_null(stream);
	assert_non_null(data);
	*bytes = fread(data, 1, 1 << 16, stream);
	fclose(stream);
	return data;
}

/* Cut anywhere: refused with a message, and nothing leaks (the address sanitizer checks). */
TEST("cut short")
{
	/* A tiled picture without its lower levels is complete. */
	static const size_t levels_at = 1000;
	static const char *const names[] = {
		"rgb.png",
		"deep.png",
		"palette.png",
		"photo.jpg",
		"coded.hdr",
		"flat.hdr",
		"colour.pfm",
		"grey.pfm",
#if WITH_EXR
		"lines_piz.exr",
		"tiles_zip.exr",
		"grey_float.exr",
		"smooth_dwab.exr",
#endif
	};

	for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
		char path[128];
		uint8_t *data;
		size_t bytes;
		struct image image;

		snprintf(path, sizeof(path), SAMPLES "%s", names[i]);
		data = slurp(path, &bytes);
		read_fine(data, bytes, &image);
		image_free(&image);
		if (!strcmp(names[i], "tiles_zip.exr"))
			bytes = levels_at;
		if (!strcmp(names[i], "photo.jpg"))
			bytes -= 2; /* its end marker, without which it is whole */
		for (size_t cut = 0; cut < bytes; cut++) {
			/* Memory of exactly that length, so that a sanitizer sees a read beyond. */
			uint8_t *part = malloc(cut ? cut : 1);
			struct fault fault = {0};

			assert_non_null(part);
			memcpy(part, data, cut);
			if (!image_read_memory(part, cut, "part", &image, &fault))
				fail_msg("%s: %zu of %zu bytes are taken for a picture", names[i],
					 cut, bytes);
			assert_null(image.u8);
			assert_null(image.f32);
			assert_non_null(strstr(fault.text, "part: "));
			free(part);
		}
		free(data);
	}
}

TEST("not pictures")
{
	struct image image;
	struct fault fault;

	read_refused("", 0, -EBADMSG, "empty");
	read_refused("hello", 5, -ENOTSUP, "not a picture");
	assert_int_equal(image_read(in_folder("missing.png"), &image, &fault), -ENOENT);
	assert_non_null(strstr(fault.text, "missing.png"));
	assert_int_equal(image_read(folder, &image, &fault), -EISDIR);
	assert_int_equal(image_read("/dev/null", &image, &fault), -EINVAL);
}

TEST("not written")
{
	struct image light, codes, none = {0};
	struct fault fault;

	assert_int_equal(image_create_f32(&light, 4, 4), 0);
	assert_int_equal(image_create_u8(&codes, 4, 4), 0);
	assert_int_equal(image_write(in_folder("y.png"), &light, &fault), -ENOTSUP);
	assert_int_equal(image_write(in_folder("y.hdr"), &codes, &fault), -ENOTSUP);
	assert_int_equal(image_write(in_folder("y.exr"), &light, &fault), -ENOTSUP);
	assert_int_equal(image_write(in_folder("y"), &light, &fault), -ENOTSUP);
	assert_int_equal(image_write(in_folder("y.png"), &none, &fault), -EINVAL);
	assert_int_equal(image_write(in_folder("no/y.png"), &codes, &fault), -ENOENT);
	assert_int_equal(access(in_folder("y.png"), F_OK), -1);
	image_free(&light);
	image_free(&codes);
	image_free(&codes);
	assert_int_equal(image_create_u8(&codes, 0, 4), -EINVAL);
	assert_int_equal(image_create_f32(&codes, 4, IMAGE_SIDE_MAX + 1), -EINVAL);
}

static int make_folder(void **state)
{
	(void)state;
	return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
	static const char *const names[] = {"x.hdr", "x.pfm", "x.PNG"};

	(void)state;
	for (int i = 0; i < 3; i++)
		unlink(in_folder(names[i]));
	return rmdir(folder);
}

TEST_GROUP(make_folder, remove_folder);
