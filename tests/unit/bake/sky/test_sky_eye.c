/* SPDX-License-Identifier: MIT */
/* Lamps in pictures of a fisheye: linear, in several exposures, over-exposed, and noise. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bake/sky/sky_eye.h"
#include "bake/sky/sky_parts.h"
#include "hal/optics/vec.h"
#include "tests/support/expect.h"
#include "tests/support/own_folder.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"

#define DEGREE (M_PI / 180)
#define SIDE 320
#define LAMP_PX 215 /* column of the lamp; its row is the middle's */

static struct sky_eye_settings settings;
static struct sky_need need;

static int test_eye_begin(void **state)
{
	struct fault fault = {.text = ""};

	(void)state;
	settings =
		(struct sky_eye_settings){.lens = {.field_deg = 90}, .ratio = {1}, .exposures = 1};
	settings.curve.named = TRANSFER_LINEAR;
	return sky_need_create(&need, 9, &fault);
}

static int test_eye_end(void **state)
{
	(void)state;
	sky_need_free(&need);
	return 0;
}

/* Writes a linear picture, or the code values of an exposure of it: an even sky and a lamp of 3 x 3
 * pixels. noise: of the even sky, alternating. */
static const char *write_eye(const char *name, double sky, double lamp, double exposure,
			     double noise)
{
	const bool linear = strstr(name, ".pfm");
	struct fault fault = {.text = ""};
	struct image image;

	assert_int_equal(linear ? image_create_f32(&image, SIDE, SIDE)
				: image_create_u8(&image, SIDE, SIDE),
			 0);
	for (int i = 0; i < SIDE * SIDE; i++) {
		const bool in = abs(i % SIDE - LAMP_PX) <= 1 && abs(i / SIDE - SIDE / 2) <= 1;
		const double light = (in ? lamp : sky + noise * (i * 7919 % 5 - 2)) * exposure;

		for (int c = 0; c < 3; c++) {
			if (linear)
				image.f32[3 * i + c] = (float)light;
			else
				image.u8[3 * i + c] =
					(uint8_t)lround(255 * fmax(0, fmin(1, light)));
		}
	}
	expect_success(image_write(own_folder_path(name), &image, &fault), &fault);
	image_free(&image);
	return own_folder_path(name);
}

/* Adds pictures of the folder as a moment; returns the parts. */
static struct sky_parts parts_of(const char *const *name)
{
	struct fault fault = {.text = ""};
	char path[EXPOSURES_MAX][512], *paths[EXPOSURES_MAX];
	struct sky_parts parts;

	for (int k = 0; k < settings.exposures; k++) {
		snprintf(path[k], sizeof(path[k]), "%s", own_folder_path(name[k]));
		paths[k] = path[k];
	}
	expect_success(sky_need_add_pictures(&need, &settings, paths, &fault), &fault);
	expect_success(sky_parts_choose(&parts, &need, 1500, &fault), &fault);
	for (int k = 0; k < settings.exposures; k++)
		unlink(path[k]);
	return parts;
}

/* The direction of the lamp: camera x is world X. */
static bool is_lamp(const struct dome_fine *part)
{
	const double theta = (LAMP_PX + 0.5 - SIDE / 2) / (SIDE / 2) * M_PI / 2;
	const double lamp[3] = {sin(theta), 0, cos(theta)};

	return vec_angle(part->direction, lamp) < 1.5 * DEGREE;
}

static bool has_lamp(const struct sky_parts *parts)
{
	for (int k = 0; k < parts->count; k++)
		if (is_lamp(&parts->part[k]) && parts->part[k].frequency >= 36)
			return true;
	return false;
}

TEST_BETWEEN("linear", test_eye_begin, test_eye_end)
{
	struct sky_parts parts;

	write_eye("even.pfm", 1, 1, 1, 0);
	parts = parts_of((const char *const[]){"even.pfm"});
	assert_int_equal(parts.count, 0);
	sky_parts_free(&parts);
	write_eye("lamp.pfm", 1, 2000, 1, 0);
	parts = parts_of((const char *const[]){"lamp.pfm"});
	assert_true(has_lamp(&parts));
	expect_below(parts.count, 4, "parts");
	sky_parts_free(&parts);
}

/* A lamp of 8 times white in one picture: brackets measure it, as the linear picture does, and
 * leave out what is only a little brighter than the sky. */
TEST_BETWEEN("bracket", test_eye_begin, test_eye_end)
{
	struct sky_need linear;
	struct fault fault = {.text = ""};
	struct sky_parts parts;
	char *path[1];
	double most = 0, worst = 0;

	settings.exposures = 3;
	settings.ratio[1] = 0.25;
	settings.ratio[2] = 0.0625;
	write_eye("a.png", 0.3, 8, 1, 0);
	write_eye("b.png", 0.3, 8, 0.25, 0);
	write_eye("c.png", 0.3, 8, 0.0625, 0);
	parts = parts_of((const char *const[]){"a.png", "b.png", "c.png"});
	sky_parts_free(&parts);
	expect_success(sky_need_create(&linear, 9, &fault), &fault);
	settings.exposures = 1;
	path[0] = (char *)(uintptr_t)write_eye("d.pfm", 0.3, 8, 1, 0);
	expect_success(sky_need_add_pictures(&linear, &settings, path, &fault), &fault);
	unlink(path[0]);
	for (int i = 0; i < sky_need_pieces(&need)->count; i++) {
		most = fmax(most, linear.share[i]);
		worst = fmax(worst, fabs(linear.share[i] - need.share[i]));
	}
	expect_below(worst, 0.02 * most, "share");
	sky_need_free(&linear);
}

/* A lamp that all pictures clip counts for more than its white. */
TEST_BETWEEN("over exposed", test_eye_begin, test_eye_end)
{
	struct sky_parts parts;

	write_eye("clipped.png", 0.3, 1, 1, 0);
	parts = parts_of((const char *const[]){"clipped.png"});
	assert_true(has_lamp(&parts));
	sky_parts_free(&parts);
}

/* In the dark there is noise of a few code values alone. */
TEST_BETWEEN("noise is no lamp", test_eye_begin, test_eye_end)
{
	struct sky_parts parts;

	write_eye("dark.png", 0.002, 0.002, 1, 0.002);
	parts = parts_of((const char *const[]){"dark.png"});
	assert_int_equal(parts.count, 0);
	sky_parts_free(&parts);
}

/* A lamp that shone at one moment stays a part. */
TEST_BETWEEN("moments", test_eye_begin, test_eye_end)
{
	struct sky_parts parts;

	write_eye("on.pfm", 1, 2000, 1, 0);
	parts = parts_of((const char *const[]){"on.pfm"});
	sky_parts_free(&parts);
	for (int k = 0; k < (thorough() ? 3 : 1); k++) {
		write_eye("off.pfm", 100, 100, 1, 0);
		parts = parts_of((const char *const[]){"off.pfm"});
		assert_true(has_lamp(&parts));
		sky_parts_free(&parts);
	}
}

TEST_BETWEEN("wrong pictures", test_eye_begin, test_eye_end)
{
	struct fault fault = {.text = ""};
	struct image small;
	char first[512], second[512], *path[2] = {first, second};

	settings.exposures = 2;
	settings.ratio[1] = 0.5;
	snprintf(first, sizeof(first), "%s", write_eye("a.pfm", 1, 1, 1, 0));
	snprintf(second, sizeof(second), "%s", own_folder_path("none.png"));
	assert_int_equal(sky_need_add_pictures(&need, &settings, path, &fault), -EINVAL);
	assert_non_null(strstr(fault.text, "a.pfm: is linear light"));
	unlink(first);
	snprintf(first, sizeof(first), "%s", write_eye("a.png", 1, 1, 1, 0));
	assert_int_equal(sky_need_add_pictures(&need, &settings, path, &fault), -ENOENT);
	assert_int_equal(image_create_u8(&small, 30, 30), 0);
	expect_success(image_write(second, &small, &fault), &fault);
	image_free(&small);
	assert_int_equal(sky_need_add_pictures(&need, &settings, path, &fault), -EINVAL);
	assert_non_null(strstr(fault.text, "none.png: is 30x30 pixels"));
	unlink(first);
	unlink(second);
}

TEST_GROUP(own_folder_make, own_folder_remove);
