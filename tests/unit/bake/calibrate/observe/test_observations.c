/* SPDX-License-Identifier: MIT */
/* What a calibration sees: views with their points, and files of points. */
#include <errno.h>
#include <string.h>

#include <stdio.h>
#include <unistd.h>

#include "bake/calibrate/observe/observations.h"
#include "tests/support/expect.h"
#include "tests/support/own_folder.h"
#include "tests/support/test.h"

static const struct points_convention ours = {.pixel_centre = 0.5};

static void write_points(const char *text, size_t bytes)
{
	FILE *file = fopen(own_folder_path("points.dat"), "w");

	assert_non_null(file);
	assert_int_equal(fwrite(text, 1, bytes, file), bytes);
	assert_int_equal(fclose(file), 0);
}

static int read_points(struct observations *all, const char *text,
		       const struct points_convention *convention, struct fault *fault)
{
	int err;

	write_points(text, strlen(text));
	err = observations_read(all, own_folder_path("points.dat"), convention, fault);
	unlink(own_folder_path("points.dat"));
	return err;
}

/* The points of a view follow each other, however many there are. */
TEST("views")
{
	struct observations all = {0};

	for (int v = 0; v < 100; v++) {
		char name[16];

		snprintf(name, sizeof(name), "view %d", v);
		assert_int_equal(observations_begin_view(&all, name), 0);
		for (int i = 0; i < v; i++)
			assert_int_equal(observations_add(&all, (double[]){v, i, 0},
							  (double[]){i, v}, "%s, %d", name, i),
					 0);
	}
	assert_int_equal(all.views, 100);
	assert_int_equal(all.count, 4950);
	for (int v = 0; v < 100; v++) {
		expect_equal(all.view[v].count, v, "v=%d", v);
		for (int i = 0; i < v; i++) {
			const struct observation *point = &all.point[all.view[v].first + i];

			expect_equal(point->view, v, "v=%d, i=%d", v, i);
			expect_that(point->world[0] == v && point->px[0] == i, "v=%d, i=%d", v, i);
		}
	}
	assert_string_equal(all.point[4949].name, "view 99, 98");
	observations_free(&all);
	observations_free(&all);
	assert_int_equal(all.count, 0);
}

TEST("long names")
{
	struct observations all = {0};
	char name[600];

	memset(name, 'n', sizeof(name) - 1);
	name[sizeof(name) - 1] = 0;
	assert_int_equal(observations_begin_view(&all, name), 0);
	assert_int_equal(observations_add(&all, (double[3]){0}, (double[2]){0}, "%s", name), 0);
	assert_int_equal(strlen(all.view[0].name), sizeof(all.view[0].name) - 1);
	assert_int_equal(strlen(all.point[0].name), OBSERVATION_NAME_MAX - 1);
	observations_free(&all);
}

TEST("files")
{
	static const char text[] = "# board\n"
				   "\n"
				   "1 2 3 40.5 50\n"
				   "  \t\n"
				   "-1e-3,+2; .5\t100 200 # said afterwards\r\n"
				   "16 0 0 1 2";
	struct observations all = {0};
	struct fault fault = {{0}};

	assert_int_equal(read_points(&all, text, &ours, &fault), 0);
	assert_int_equal(all.views, 1);
	assert_int_equal(all.count, 3);
	assert_string_equal(all.point[0].name, "points.dat:3");
	assert_string_equal(all.point[1].name, "points.dat:5");
	assert_true(all.point[0].px[0] == 40.5 && all.point[0].px[1] == 50);
	assert_true(all.point[1].world[0] == -1e-3 && all.point[1].world[2] == 0.5);
	assert_true(all.point[2].world[0] == 16);
	/* A second file is a second view. */
	assert_int_equal(read_points(&all, "0 0 0 1 2\n", &ours, &fault), 0);
	assert_int_equal(all.views, 2);
	assert_int_equal(all.point[3].view, 1);
	observations_free(&all);
}

/* The middle of the upper left pixel in a picture of 480 lines, in the conventions of different
 * programs. */
TEST("conventions")
{
	static const struct {
		struct points_convention convention;
		const char *text;
	} cases[] = {
		{{.pixel_centre = 0.5}, "0 0 0 0.5 0.5"},
		{{.pixel_centre = 0}, "0 0 0 0 0"},
		{{.height = 480, .y_up = 1, .pixel_centre = 0.5}, "0 0 0 0.5 479.5"},
		{{.height = 480, .y_up = 1, .pixel_centre = 0}, "0 0 0 0 479"},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct observations all = {0};
		struct fault fault = {{0}};

		assert_int_equal(read_points(&all, cases[i].text, &cases[i].convention, &fault), 0);
		expect_that(all.point[0].px[0] == 0.5 && all.point[0].px[1] == 0.5, "i=%zu", i);
		observations_free(&all);
	}
}

TEST("wrong files")
{
	static const struct {
		const char *text, *says;
	} cases[] = {
		{"", "holds no points"},
		{"# nothing\n\n", "holds no points"},
		{"1 2 3 4 5\n1 2 3 4\n", "points.dat:2: expected five finite numbers"},
		{"1 2 3 4 5 6\n", "points.dat:1: expected five"},
		{"1 2 3 4 5 6 7 8 9\n", "points.dat:1: expected five"},
		{"1 2 3 4 five\n", "points.dat:1: expected five"},
		{"1 2 3 4 0x10\n", "points.dat:1: expected five"},
		{"1 2 3 4 5x\n", "points.dat:1: expected five"},
		{"1 2 3 4 nan\n", "points.dat:1: expected five"},
		{"1 2 3 -inf 5\n", "points.dat:1: expected five"},
		{"1 2 3 4 1e999\n", "points.dat:1: expected five"},
		{"x y z u v\n1 2 3 4 5\n", "points.dat:1: expected five"},
	};
	struct observations all = {0};
	struct fault fault = {{0}};

	assert_int_equal(read_points(&all, "1 2 3 4 5", &ours, &fault), 0);
	/* a byte order mark, which some editors write */
	assert_int_equal(read_points(&all,
				     "\xef\xbb\xbf"
				     "1 2 3 4 5\r\n",
				     &ours, &fault),
			 0);
	assert_int_equal(all.count, 2);
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		expect_equal(read_points(&all, cases[i].text, &ours, &fault), -EINVAL, "i=%zu", i);
		if (!strstr(fault.text, cases[i].says))
			fail_msg("\"%s\" does not say \"%s\"", fault.text, cases[i].says);
		/* nothing is kept of a refused file */
		expect_equal(all.views, 2, "i=%zu", i);
		expect_equal(all.count, 2, "i=%zu", i);
	}
	write_points("1 2 3 4 5\0 6\n", 13);
	assert_int_equal(observations_read(&all, own_folder_path("points.dat"), &ours, &fault),
			 -EINVAL);
	unlink(own_folder_path("points.dat"));
	assert_int_equal(observations_read(&all, own_folder_path("none.dat"), &ours, &fault),
			 -ENOENT);
	assert_int_equal(observations_read(&all, own_folder(), &ours, &fault), -EISDIR);
	observations_free(&all);
}

TEST_GROUP(own_folder_make, own_folder_remove);
