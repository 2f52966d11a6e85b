/* SPDX-License-Identifier: MIT */
/* Lights files: values come back to the bit, and messages name what is wrong. */
#include <errno.h>
#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/lights/lights_file.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/own_folder.h"
#include "tests/support/test.h"

static void write_text(const char *path, const char *text, size_t bytes)
{
	FILE *stream = fopen(path, "wb");

	assert_non_null(stream);
	assert_int_equal(fwrite(text, 1, bytes, stream), bytes);
	assert_int_equal(fclose(stream), 0);
}

TEST("to the bit and back")
{
	static float lights[1000][3], back[1000][3];
	struct chance chance = chance_begin("lights_file");
	const char *path = own_folder_path("lights.txt");

	for (int i = 0; i < 1000; i++)
		for (int c = 0; c < 3; c++)
			lights[i][c] = (float)pow(10, chance_real(&chance, -45, 38));
	lights[0][0] = 0;
	lights[0][1] = FLT_MAX;
	lights[0][2] = FLT_TRUE_MIN;
	assert_int_equal(lights_file_write(path, (const float(*)[3])lights, 1000, NULL), 0);
	assert_int_equal(lights_file_read(path, back, 1000, NULL), 0);
	assert_memory_equal(lights, back, sizeof(lights));
	unlink(path);
}

TEST("comments and blanks")
{
	static const char text[] =
		"\xef\xbb\xbf# lights\n\n  1 2 3  # the sun\r\n\t\n0.5\t.25 1e-3\n7 8 9";
	const char *path = own_folder_path("lights.txt");
	const float want[3][3] = {{1, 2, 3}, {0.5f, 0.25f, 1e-3f}, {7, 8, 9}};
	float lights[3][3];

	write_text(path, text, strlen(text));
	assert_int_equal(lights_file_read(path, lights, 3, NULL), 0);
	assert_memory_equal(lights, want, sizeof(want));
	/* the reader stops behind the last light, even of an endless file */
	assert_int_equal(lights_file_read("/dev/zero", lights, 3, NULL), -EINVAL);
	unlink(path);
}

/* The message names the line. */
TEST("refused")
{
	static const struct {
		const char *text, *place, *what;
	} bad[] = {
		{"1 1 1\n2 2\n", ":2: ", "\"2 2\""},
		{"1 1 1\n\n2 2 2 2\n", ":3: ", "\"2 2 2 2\""},
		{"1 1 1\n2 2 x\n", ":2: ", "not a colour"},
		{"1 1 1\n2 2 2x\n", ":2: ", "not a colour"},
		{"1 1 1\n1 -1 1\n", ":2: ", "not a colour"},
		{"1 1 nan\n", ":1: ", "not a colour"},
		{"1 inf 1\n", ":1: ", "not a colour"},
		{"1 1e40 1\n", ":1: ", "not a colour"},
		{"1,1,1\n", ":1: ", "not a colour"},
		{"1 1 1\n", ":1: ", "after 1 lights, expected 2"},
		{"", ": ", "holds no lights, expected 2 lines"},
		{"# none\n\n", ": ", "holds no lights, expected 2 lines"},
		{"0x10 1 1\n", ":1: ", "not a colour"},
		{"1 1 0x1p3\n", ":1: ", "not a colour"},
		{"1 1 1\n2 2 2\n3 3 3\n", ":3: ", "more than the 2 lights"},
	};
	const char *path = own_folder_path("lights.txt");
	float lights[2][3];

	for (unsigned i = 0; i < sizeof(bad) / sizeof(*bad); i++) {
		struct fault fault = {""};

		write_text(path, bad[i].text, strlen(bad[i].text));
		expect_equal(lights_file_read(path, lights, 2, &fault), -EINVAL, "i=%u", i);
		assert_memory_equal(fault.text, path, strlen(path));
		assert_memory_equal(fault.text + strlen(path), bad[i].place, strlen(bad[i].place));
		assert_non_null(strstr(fault.text, bad[i].what));
	}
	write_text(path, "1 1 1\n1 1 1\0 1\n", 15);
	assert_int_equal(lights_file_read(path, lights, 2, NULL), -EINVAL);
	unlink(path);
}

TEST("files that cannot be")
{
	const float lights[1][3] = {{1, 2, 3}};
	struct fault fault = {""};
	float back[1][3];

	assert_int_equal(lights_file_read(own_folder_path("missing.txt"), back, 1, &fault),
			 -ENOENT);
	assert_non_null(strstr(fault.text, "missing.txt"));
	assert_int_equal(lights_file_read(own_folder(), back, 1, &fault), -EISDIR);
	assert_int_equal(lights_file_write(own_folder_path("no/such.txt"), lights, 1, &fault),
			 -ENOENT);
	assert_non_null(strstr(fault.text, "such.txt"));
}

TEST_GROUP(own_folder_make, own_folder_remove);
