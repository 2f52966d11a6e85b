/* SPDX-License-Identifier: MIT */
/* Lists of finer parts of the sky: what is read, and what is refused, by line. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "bake/sky/fine_list.h"
#include "hal/optics/vec.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

static char folder[] = "/tmp/test_fine_list_XXXXXX";

static int make_folder(void **state)
{
	(void)state;
	return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
	(void)state;
	return rmdir(folder);
}

/* Reads a file of this text, named fine.txt. */
static int read_text(const char *text, struct fine_list *list, struct fault *fault)
{
	char path[80];
	FILE *file;
	int err;

	snprintf(path, sizeof(path), "%s/fine.txt", folder);
	file = fopen(path, "w");
	assert_non_null(file);
	fputs(text, file);
	fclose(file);
	err = fine_list_read(list, "scene: [dome] fine", "fine.txt", folder, fault);
	unlink(path);
	return err;
}

TEST("a file and a text")
{
	struct fine_list file, text;
	struct fault fault = {.text = ""};

	expect_success(
		read_text("# lamps\n\n90 0 1.5 18  # a window\n-30 45 0.25 72\r\n", &file, &fault),
		&fault);
	expect_success(fine_list_read(&text, "--fine", "90 0 1.5 18, -30 45 0.25 72", NULL, &fault),
		       &fault);
	assert_int_equal(file.count, 2);
	assert_int_equal(text.count, 2);
	for (int k = 0; k < 2; k++) {
		expect_below(vec_angle(file.part[k].direction, text.part[k].direction), 1e-15,
			     "k=%d", k);
		expect_equal(file.part[k].frequency, k ? 72 : 18, "k=%d", k);
	}
	assert_true(fabs(file.part[0].direction[1] - 1) < 1e-15);
	assert_true(fabs(file.part[1].radius_rad - 0.25 * M_PI / 180) < 1e-15);
	fine_list_free(&file);
	fine_list_free(&text);
}

/* What is written is read again. */
TEST("written")
{
	char *text = NULL;
	size_t size;
	FILE *stream = open_memstream(&text, &size);
	struct fault fault = {.text = ""};
	struct fine_list list, again;

	expect_success(fine_list_read(&list, "--fine", "-170.25 33.5 2.75 36", NULL, &fault),
		       &fault);
	fine_list_write(stream, &list.part[0]);
	fclose(stream);
	expect_success(read_text(text, &again, &fault), &fault);
	assert_true(vec_angle(list.part[0].direction, again.part[0].direction) < 1e-12);
	assert_int_equal(again.part[0].frequency, 36);
	free(text);
	fine_list_free(&list);
	fine_list_free(&again);
}

TEST("refused by line")
{
	static const struct {
		const char *text, *message;
	} cases[] = {
		{"10 20 1 18\n10 20 3 36\n", "fine.txt:2: this direction is there twice"},
		{"10 -2 1 18\n",
		 "fine.txt:1: the direction is below the horizon or beyond the zenith, expected a height of 0 to 90 degrees"},
		{"\n10 20 1\n",
		 "fine.txt:2: expected \"azimuth height radius frequency\", in degrees, such as \"120 35 2 36\""},
		{"10 20 1 18 5\n",
		 "fine.txt:1: expected \"azimuth height radius frequency\", in degrees, such as \"120 35 2 36\""},
		{"10 20 1 73\n",
		 "fine.txt:1: expected \"azimuth height radius frequency\", in degrees, such as \"120 35 2 36\""},
		{"10 20 100 18\n", "fine.txt:1: expected a radius of 0 to 90 degrees"},
	};
	struct fine_list list;
	char expected[256];

	for (size_t k = 0; k < sizeof(cases) / sizeof(*cases); k++) {
		struct fault fault = {.text = ""};

		expect_equal(read_text(cases[k].text, &list, &fault), -EINVAL, "k=%zu", k);
		snprintf(expected, sizeof(expected), "%s/%s", folder, cases[k].message);
		assert_string_equal(fault.text, expected);
		expect_equal(list.count, 0, "k=%zu", k);
	}
}

/* What the dome refuses is told by the list's place, too. */
TEST("refused by the dome")
{
	struct fault fault = {.text = ""};
	struct fine_list list;
	struct dome dome;

	expect_success(fine_list_read(&list, "--fine", "0 20 1 18, 90 20 1 20", NULL, &fault),
		       &fault);
	assert_int_equal(fine_list_dome(&list, 9, &dome, &fault), -EINVAL);
	assert_string_equal(
		fault.text,
		"--fine: part 2: frequency is 20, expected a multiple of the dome's 9 up to 72");
	fine_list_free(&list);
	assert_int_equal(fine_list_read(&list, "--fine", "/nowhere/fine.txt", NULL, &fault),
			 -ENOENT);
}

TEST_GROUP(make_folder, remove_folder);
