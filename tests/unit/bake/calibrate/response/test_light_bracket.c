/* SPDX-License-Identifier: MIT */
/* Brackets as people have them: merging, hdrgen's files, exposure times that pictures say. */
#include <math.h>

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <libexif/exif-data.h>

#include "bake/calibrate/bracket/light_exif.h"
#include "bake/calibrate/bracket/light_merge.h"
#include "bake/calibrate/bracket/light_rsp.h"
#include "tests/support/expect.h"
#include "tests/support/own_folder.h"
#include "tests/support/test.h"

#define WIDTH 64
#define HEIGHT 16
#define EXPOSURES 8

/* Light of a pixel: four decades from left to right. */
static double light_at(int x)
{
	return pow(10, 4.0 * x / WIDTH - 2);
}

/* What a camera makes of linear light: sRGB, with pixels near white that have lost light. */
static uint8_t code_of(double linear)
{
	const struct transfer_curve curve = {.named = TRANSFER_SRGB};
	const double code = 255 * transfer_curve_encode(&curve, fmin(linear, 1));

	return (uint8_t)lrint(code > 250 ? 250 + (code - 250) / 2 : code);
}

/* Within rounding of the code values, also where one exposure is near white: weights that end at
 * 255 lose 2 % there. */
TEST("merges")
{
	const struct transfer_curve curve = {.named = TRANSFER_SRGB};
	struct image picture[EXPOSURES];
	double time[EXPOSURES];
	struct light_merged merged;

	for (int j = 0; j < EXPOSURES; j++) {
		time[j] = 40 * pow(0.25, j);
		assert_int_equal(image_create_u8(&picture[j], WIDTH, HEIGHT), 0);
		for (int i = 0; i < WIDTH * HEIGHT * 3; i++)
			picture[j].u8[i] = code_of(light_at(i / 3 % WIDTH) * time[j]);
	}
	assert_int_equal(light_merge(&merged, picture, time, EXPOSURES, &curve, NULL), 0);
	assert_true(merged.clipped == 0 && merged.dark == 0);
	for (int x = 0; x < WIDTH; x++)
		expect_at_most(fabs(merged.picture.f32[3 * x] / light_at(x) - 1), 0.01, "x=%d", x);
	image_free(&merged.picture);
	/* two exposures alone leave the brightest clipped and the darkest black */
	assert_int_equal(light_merge(&merged, picture + 1, time + 1, 2, &curve, NULL), 0);
	assert_true(merged.clipped > 0.3 && merged.clipped < 0.8);
	image_free(&merged.picture);
	for (int j = 0; j < EXPOSURES; j++)
		image_free(&picture[j]);
}

static void rsp_text(const char *text)
{
	FILE *file = fopen(own_folder_path("camera.rsp"), "w");

	assert_non_null(file);
	fputs(text, file);
	assert_int_equal(fclose(file), 0);
}

TEST("reads rsp")
{
	static const char *const wrong[] = {"", "3 1 2\n3 1 2\n3 1 2\n", "1 1 0\n1 1 0\n",
					    "2 -1 0 1\n2 -1 0 1\n2 -1 0 1\n", "one\n"};
	struct transfer_curve curve;
	struct fault fault;
	double apart;

	/* as hdrgen writes it: the order, then the coefficients from the highest */
	rsp_text("2 0.75 0.25 0\n2 0.75 0.25 0\n2 0.75 0.25 0\n");
	assert_int_equal(light_rsp_read(own_folder_path("camera.rsp"), &curve, &apart, &fault), 0);
	expect_below(apart, 1e-12, "%s", "alike");
	for (int k = 0; k < TRANSFER_KNOTS; k++) {
		const double u = (double)k / (TRANSFER_KNOTS - 1);

		expect_at_most(fabs(curve.knot[k] - 0.75 * u * u - 0.25 * u), 1e-12, "k=%d", k);
	}
	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
		rsp_text(wrong[i]);
		expect_equal(light_rsp_read(own_folder_path("camera.rsp"), &curve, &apart, &fault),
			     -EINVAL, "i=%zu", i);
		assert_non_null(strstr(fault.text, "camera.rsp"));
	}
	assert_int_equal(remove(own_folder_path("camera.rsp")), 0);
}

/* A JPEG that holds nothing but EXIF data. */
static void write_exif(unsigned over, unsigned under)
{
	ExifData *data = exif_data_new();
	ExifEntry *entry = exif_entry_new();
	unsigned char *bytes = NULL;
	unsigned count = 0;
	FILE *file = fopen(own_folder_path("a.jpg"), "wb");

	assert_true(data && entry && file);
	exif_content_add_entry(data->ifd[EXIF_IFD_EXIF], entry);
	exif_entry_initialize(entry, EXIF_TAG_EXPOSURE_TIME);
	exif_set_rational(entry->data, exif_data_get_byte_order(data), (ExifRational){over, under});
	exif_data_save_data(data, &bytes, &count);
	fputs("\xff\xd8\xff\xe1", file);
	fputc((int)((count + 2) >> 8), file);
	fputc((int)((count + 2) & 255), file);
	assert_int_equal(fwrite(bytes, 1, count, file), count);
	fputs("\xff\xd9", file);
	assert_int_equal(fclose(file), 0);
	free(bytes);
	exif_entry_unref(entry);
	exif_data_unref(data);
}

TEST("reads times")
{
	struct fault fault;
	double exposure;

	write_exif(1, 60);
	assert_int_equal(light_exif_exposure(own_folder_path("a.jpg"), &exposure, &fault), 0);
	assert_float_equal(exposure, 1 / 60.0, 1e-12);
	write_exif(13, 0);
	assert_int_equal(light_exif_exposure(own_folder_path("a.jpg"), &exposure, &fault),
			 -ENODATA);
	assert_non_null(strstr(fault.text, "--times"));
	assert_int_equal(remove(own_folder_path("a.jpg")), 0);
	assert_int_equal(light_exif_exposure(own_folder_path("a.jpg"), &exposure, &fault), -ENOENT);
}

TEST_GROUP(own_folder_make, own_folder_remove);
