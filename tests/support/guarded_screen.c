/* SPDX-License-Identifier: MIT */
#include "tests/support/guarded_screen.h"
#include "tests/support/expect.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

struct guarded_screen guarded_screen_create(int width, int height, int fill)
{
	const size_t page = (size_t)sysconf(_SC_PAGESIZE);
	size_t stride = (size_t)width * 4 + GUARD_PADDING, used = stride * (size_t)height;
	size_t inner = (used + page - 1) / page * page;
	struct guarded_screen s = {.bytes = inner + 2 * page};

	s.map = mmap(NULL, s.bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
	assert_true(s.map != MAP_FAILED);
	assert_int_equal(mprotect(s.map, page, PROT_NONE), 0);
	assert_int_equal(mprotect(s.map + page + inner, page, PROT_NONE), 0);
	s.buffer = (struct display_buffer){
		.pixels = s.map + page + inner - used,
		.stride = stride,
		.width = width,
		.height = height,
	};
	memset(s.map + page, GUARD_CANARY, inner);
	for (int y = 0; y < height; y++)
		memset(s.buffer.pixels + (size_t)y * stride, fill, (size_t)width * 4);
	return s;
}

const uint8_t *guarded_screen_pixel(const struct guarded_screen *s, int x, int y)
{
	return s->buffer.pixels + (size_t)y * s->buffer.stride + (size_t)x * 4;
}

void guarded_screen_free(struct guarded_screen *s)
{
	const size_t page = (size_t)sysconf(_SC_PAGESIZE);

	for (uint8_t *p = s->map + page; p < s->buffer.pixels; p++)
		assert_int_equal(*p, GUARD_CANARY);
	for (int y = 0; y < s->buffer.height; y++) {
		const uint8_t *end = guarded_screen_pixel(s, s->buffer.width, y);

		for (int i = 0; i < GUARD_PADDING; i++)
			expect_equal(end[i], GUARD_CANARY, "y=%d, i=%d", y, i);
	}
	munmap(s->map, s->bytes);
}
