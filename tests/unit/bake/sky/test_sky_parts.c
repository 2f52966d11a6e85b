/* SPDX-License-Identifier: MIT */
/* Parts of synthetic skies: an even one, a sun, two lamps, and the limit of lights. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/sky/fine_list.h"
#include "bake/sky/sky_parts.h"
#include "hal/optics/vec.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define DEGREE (M_PI / 180)
#define FREQUENCY 9

static struct image image;
static const struct panorama panorama = {.image = &image, .scale = 1};
static struct dome dome;     /* the base */
static struct sky_need need; /* its domes take seconds to create */

static int test_sky_begin_all(void **state)
{
	struct fault fault;

	(void)state;
	return image_create_f32(&image, 1024, 512) || dome_create(&dome, FREQUENCY, &fault) ||
	       sky_need_create(&need, FREQUENCY, &fault);
}

static int test_sky_begin(void **state)
{
	(void)state;
	for (size_t i = 0; i < (size_t)3 * 1024 * 512; i++)
		image.f32[i] = 1;
	return 0;
}

static int test_sky_end_all(void **state)
{
	(void)state;
	image_free(&image);
	dome_free(&dome);
	sky_need_free(&need);
	return 0;
}

/* A disc of uniform radiance. */
static void add_disc_at(const double middle[3], double diameter_deg, float radiance)
{
	for (int y = 0; y < image.height; y++)
		for (int x = 0; x < image.width; x++) {
			float *rgb = image.f32 + 3 * ((size_t)y * (size_t)image.width + (size_t)x);
			double d[3];

			panorama_direction(&panorama, x + 0.5, y + 0.5, d);
			for (int c = 0; c < 3; c++)
				if (vec_angle(d, middle) <= diameter_deg / 2 * DEGREE)
					rgb[c] = radiance;
		}
}

/* The same around the node of a cell, or a little aside. */
static void add_disc(int cell, double aside_deg, double diameter_deg, float radiance,
		     double middle[3])
{
	const double *node = dome.direction[cell];

	for (int k = 0; k < 3; k++)
		middle[k] = node[k] + (k == 2 ? aside_deg * DEGREE : 0);
	vec_normalize(middle);
	add_disc_at(middle, diameter_deg, radiance);
}

static int choose_under(const struct panorama *sky, int most, struct sky_parts *parts)
{
	struct fault fault = {.text = ""};

	memset(need.moved, 0, (size_t)dome.count * sizeof(*need.moved));
	memset(need.share, 0, (size_t)sky_need_pieces(&need)->count * sizeof(*need.share));
	sky_need_add_panorama(&need, sky);
	return sky_parts_choose(parts, &need, most, &fault);
}

static struct sky_parts choose(int most)
{
	struct sky_parts parts;

	assert_int_equal(choose_under(&panorama, most, &parts), 0);
	return parts;
}

/* The frequency of the part in a cell; 0: none. */
static int frequency_at(const struct sky_parts *parts, int cell)
{
	for (int k = 0; k < parts->count; k++)
		if (dome_cell_of(&dome, parts->part[k].direction) == cell)
			return parts->part[k].frequency;
	return 0;
}

TEST_BETWEEN("even sky needs no part", test_sky_begin, NULL)
{
	struct sky_parts parts = choose(1000);

	assert_int_equal(parts.count, 0);
	assert_int_equal(parts.lights, dome.count);
	assert_false(parts.limited);
	sky_parts_free(&parts);
}

TEST_BETWEEN("sun is found", test_sky_begin, NULL)
{
	struct fault fault;
	struct sky_parts parts;
	struct dome fine;
	double sun[3];
	int light;
	int wrong;

	add_disc(100, 1, 0.5, 20000, sun);
	parts = choose(1000);
	assert_int_equal(parts.count, 1);
	assert_int_equal(parts.part[0].frequency, 72);
	assert_int_equal(dome_cell_of(&dome, sun), dome_cell_of(&dome, parts.part[0].direction));
	assert_true(vec_angle(sun, parts.part[0].direction) < 1 * DEGREE);
	assert_int_equal(dome_create_fine(&fine, FREQUENCY, parts.part, 1, &wrong, &fault), 0);
	assert_int_equal(fine.count, parts.lights);
	light = dome_cell_of(&fine, sun);
	assert_true(vec_angle(fine.direction[light], sun) < atan(2) / 72);
	dome_free(&fine);
	sky_parts_free(&parts);
}

/* On the border of two cells lights are fine on both sides, also by the list as it is written. */
TEST_BETWEEN("sun at a border", test_sky_begin, NULL)
{
	const double *from = dome.direction[100];
	struct fault fault = {.text = ""};
	struct fine_list list;
	struct sky_parts parts;
	struct dome fine;
	double sun[3], best = -1;
	char *text = NULL;
	size_t size;
	FILE *stream;
	int nearest = 0;

	for (int i = 0; i < dome.count; i++)
		if (i != 100 && vec_dot(dome.direction[i], from) > best) {
			best = vec_dot(dome.direction[i], from);
			nearest = i;
		}
	for (int k = 0; k < 3; k++)
		sun[k] = from[k] + dome.direction[nearest][k];
	vec_normalize(sun);
	add_disc_at(sun, 0.5, 20000);
	parts = choose(1000);
	stream = open_memstream(&text, &size);
	for (int k = 0; k < parts.count; k++) {
		if (k)
			fputc(',', stream);
		fine_list_write(stream, &parts.part[k]);
		fseek(stream, -1, SEEK_CUR); /* over the end of the line */
	}
	fclose(stream);
	text[strcspn(text, "\n")] = '\0';
	expect_success(fine_list_read(&list, "list", text, NULL, &fault), &fault);
	expect_success(fine_list_dome(&list, FREQUENCY, &fine, &fault), &fault);
	assert_int_equal(fine.count, parts.lights);
	for (int k = 0; k < 12; k++) {
		const double turn = 2 * M_PI * k / 12;
		const double near[3] = {sun[0] + 0.4 * DEGREE * cos(turn),
					sun[1] + 0.4 * DEGREE * sin(turn), sun[2]};
		const int light = dome_cell_of(&fine, near);

		expect_below(dome_cell_reach_rad(&fine, light), 1.2 * atan(2) / 72, "k=%d", k);
	}
	dome_free(&fine);
	fine_list_free(&list);
	sky_parts_free(&parts);
	free(text);
}

TEST_BETWEEN("turn turns parts", test_sky_begin, NULL)
{
	struct panorama turned = panorama;
	struct sky_parts parts;
	double sun[3], to[3];

	add_disc(100, 1, 0.5, 20000, sun);
	turned.turn_rad = 72 * DEGREE; /* the dome's own symmetry */
	assert_int_equal(choose_under(&turned, 1000, &parts), 0);
	to[0] = cos(turned.turn_rad) * sun[0] - sin(turned.turn_rad) * sun[1];
	to[1] = sin(turned.turn_rad) * sun[0] + cos(turned.turn_rad) * sun[1];
	to[2] = sun[2];
	assert_int_equal(parts.count, 1);
	assert_true(vec_angle(to, parts.part[0].direction) < 1 * DEGREE);
	sky_parts_free(&parts);
}

/* A lamp nearly as large as its cell needs fewer lights than one that is smaller than the
 * finest. */
TEST_BETWEEN("two lamps are two parts", test_sky_begin, NULL)
{
	struct sky_parts parts;
	double unused[3];
	int large, small;

	add_disc(60, 0, 5, 30, unused);
	add_disc(150, 0, 0.5, 4000, unused);
	parts = choose(1000);
	large = frequency_at(&parts, 60);
	small = frequency_at(&parts, 150);
	assert_int_equal(parts.count, 2);
	assert_true(large > FREQUENCY);
	assert_int_equal(small, 72);
	assert_true(large < small);
	sky_parts_free(&parts);
}

TEST_BETWEEN("limit of lights holds", test_sky_begin, NULL)
{
	struct sky_parts parts;
	double unused[3];

	add_disc(60, 0, 0.5, 30000, unused);
	add_disc(150, 0, 0.5, 20000, unused);
	parts = choose(1000);
	assert_int_equal(parts.count, 2);
	assert_int_equal(frequency_at(&parts, 150), 72);
	sky_parts_free(&parts);
	parts = choose(500);
	assert_true(parts.limited);
	assert_in_range(parts.lights, dome.count + 1, 500);
	assert_true(frequency_at(&parts, 60) > frequency_at(&parts, 150));
	sky_parts_free(&parts);
	assert_int_equal(choose_under(&panorama, 400, &parts), -E2BIG);
	assert_null(parts.part);
}

TEST_GROUP(test_sky_begin_all, test_sky_end_all);
