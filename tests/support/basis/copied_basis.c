/* SPDX-License-Identifier: MIT */
#include "tests/support/basis/copied_basis.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/stat.h>

const struct synthetic_options copied_small = {
	.width = 37,
	.height = 21,
	.lights = 50,
	.grounds = 2,
	.coarse = 20,
	.patterns = 3,
	.columns = 5,
	.bits = 8,
	.layers = 2,
	.exact = true,
	.object_share = 0.3,
	.ground_share = 0.3,
	.stand_in_share = 0.3,
	.glass_share = 0.2,
	.mirror_share = 0.2,
	.peak = 1,
	.bounce = 0.3,
	.seed = 7,
};

struct copied copied_file(const char *path)
{
	struct copied copy = {0};
	FILE *stream = fopen(path, "rb");
	struct stat s;

	assert_non_null(stream);
	assert_int_equal(fstat(fileno(stream), &s), 0);
	copy.bytes = (size_t)s.st_size;
	copy.data = mmap(NULL, copy.bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1,
			 0);
	assert_ptr_not_equal(copy.data, MAP_FAILED);
	assert_int_equal(fread(copy.data, 1, copy.bytes, stream), copy.bytes);
	fclose(stream);
	return copy;
}

void copied_free(struct copied *copy)
{
	munmap(copy->data, copy->bytes);
}

int copied_open_part(const struct copied *copy, enum basis_part part, struct fault *fault)
{
	struct basis basis;
	int ret;

	fault->text[0] = '\0';
	ret = basis_open_memory(&basis, copy->data, copy->bytes, "mem.inlay", part, fault);
	basis_close(&basis);
	return ret;
}

int copied_open(const struct copied *copy, struct fault *fault)
{
	return copied_open_part(copy, BASIS_ALL, fault);
}

struct basis_chunk_entry *copied_chunk(const struct copied *copy, uint32_t type)
{
	struct basis_file_header *header = (struct basis_file_header *)copy->data;
	struct basis_chunk_entry *chunk = (struct basis_chunk_entry *)(header + 1);

	for (uint32_t i = 0; i < header->chunk_count; i++) {
		if (chunk[i].type == type)
			return &chunk[i];
	}
	fail_msg("chunk %08x is missing", type);
	return NULL;
}

void *copied_data(const struct copied *copy, uint32_t type)
{
	return copy->data + copied_chunk(copy, type)->offset;
}

int copied_setup(void **state)
{
	struct synthetic *s = calloc(1, sizeof(*s));

	assert_non_null(s);
	synthetic_open(s, &copied_small);
	*state = s;
	return 0;
}

int copied_teardown(void **state)
{
	synthetic_close(*state);
	free(*state);
	return 0;
}
