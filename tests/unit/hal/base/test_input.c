/* SPDX-License-Identifier: MIT */
/* Files that are read whole, and what a document of them may ask for. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/base/budget.h"
#include "hal/base/input.h"
#include "tests/support/own_folder.h"
#include "tests/support/test.h"

static void write_file(size_t bytes)
{
	FILE *file = fopen(own_folder_path("a"), "w");

	assert_non_null(file);
	for (size_t k = 0; k < bytes; k++)
		putc((int)(k % 251), file);
	assert_int_equal(fclose(file), 0);
}

TEST("files are read whole")
{
	static const size_t lengths[] = {0, 1, 4096, 100000};
	struct fault fault = {.text = ""};
	uint8_t *data;
	size_t bytes;

	for (int k = 0; k < 4; k++) {
		write_file(lengths[k]);
		assert_int_equal(input_read(own_folder_path("a"), 100000, &data, &bytes, &fault),
				 0);
		assert_int_equal(bytes, lengths[k]);
		/* a map would end the program here */
		assert_int_equal(truncate(own_folder_path("a"), 0), 0);
		for (size_t b = 0; b < bytes; b++)
			assert_int_equal(data[b], b % 251);
		free(data);
	}
	write_file(100001);
	assert_int_equal(input_read(own_folder_path("a"), 100000, &data, &bytes, &fault), -EFBIG);
	assert_non_null(strstr(fault.text, "a: more than 100000 bytes long"));
	assert_int_equal(unlink(own_folder_path("a")), 0);
	assert_int_equal(input_read(own_folder_path("a"), 100000, &data, &bytes, &fault), -ENOENT);
}

TEST("budgets are of all files")
{
	struct budget budget = {.file_bytes = 1 << 20};
	struct fault fault = {.text = ""};

	assert_int_equal(budget_take(&budget, 0x1p28, "a", &fault), 0);
	assert_int_equal(budget_fits(&budget, 0x1p28, "a", &fault), 0);
	assert_int_equal(budget_take(&budget, 0x1p28, "a", &fault), 0);
	assert_int_equal(budget_take(&budget, 1, "a", &fault), -EFBIG);
	assert_string_equal(
		fault.text,
		"a: it would take 537 MB of memory, expected at most 537 MB of 1048576 bytes in files");
	budget.file_bytes++;
	assert_int_equal(budget_take(&budget, 256, "a", &fault), 0);
}

TEST_GROUP(own_folder_make, own_folder_remove);
