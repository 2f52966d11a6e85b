/* SPDX-License-Identifier: MIT */
/* Views: from which place each pixel of an upright picture is read. */
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <string.h>

#include "hal/frame/view.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define WIDTH 37
#define HEIGHT 23
#define STRIDE (WIDTH * 4 + 12)

/* The value of each pixel is its own place. */
static void test_view_fill(uint8_t pixels[HEIGHT * STRIDE])
{
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			pixels[y * STRIDE + 4 * x] = (uint8_t)x;
			pixels[y * STRIDE + 4 * x + 1] = (uint8_t)y;
		}
}

static void check_view(const struct view *view, const uint8_t *pixels)
{
	const struct picture p = view_picture(view, pixels, STRIDE);

	assert_int_equal(p.width, view->width);
	assert_int_equal(p.height, view->height);
	for (int y = 0; y < p.height; y++)
		for (int x = 0; x < p.width; x++) {
			const uint8_t *pixel = p.origin + y * p.y_step + x * p.x_step;
			const int left = view->hflip ? p.width - 1 - x : x;
			const int top = view->vflip ? p.height - 1 - y : y;

			expect_equal(pixel[0], view->x + left, "y=%d, x=%d", y, x);
			expect_equal(pixel[1], view->y + top, "y=%d, x=%d", y, x);
		}
}

TEST("pixels are those of the view")
{
	static uint8_t pixels[HEIGHT * STRIDE];
	struct chance chance = chance_begin("view");

	test_view_fill(pixels);
	for (int k = 0; k < 400; k++) {
		struct view view = {.squash = 1, .hflip = k & 1, .vflip = k & 2};

		view.x = chance_int(&chance, 0, WIDTH - 1);
		view.y = chance_int(&chance, 0, HEIGHT - 1);
		view.width = chance_int(&chance, 0, WIDTH - view.x);
		view.height = chance_int(&chance, 0, HEIGHT - view.y);
		assert_int_equal(view_resolve(&view, WIDTH, HEIGHT, NULL), 0);
		check_view(&view, pixels);
	}
}

TEST("quadrants of a composer")
{
	struct view right = {.x = 320, .squash = 2}, whole = {.squash = 1};

	assert_int_equal(view_resolve(&right, 640, 240, NULL), 0);
	assert_int_equal(right.width, 320);
	assert_int_equal(right.height, 240);
	assert_int_equal(view_resolve(&whole, 640, 240, NULL), 0);
	assert_int_equal(whole.width, 640);
}

TEST("refused")
{
	const struct view bad[] = {
		{.x = -1, .squash = 1},
		{.y = 240, .squash = 1},
		{.x = 1, .width = 640, .squash = 1},
		{.x = 1, .width = INT_MAX, .squash = 1},
		{.y = INT_MAX, .height = INT_MAX, .squash = 1},
		{.width = -1, .squash = 1},
		{.height = INT_MIN, .squash = 1},
		{.squash = 0},
		{.squash = -1},
		{.squash = NAN},
		{.squash = INFINITY},
	};

	for (unsigned i = 0; i < sizeof(bad) / sizeof(*bad); i++) {
		struct view view = bad[i];
		struct fault fault = {""};

		expect_equal(view_resolve(&view, 640, 240, &fault), -EINVAL, "i=%u", i);
		expect_above(strlen(fault.text), 0, "i=%u", i);
		assert_memory_equal(&view.x, &bad[i].x, 4 * sizeof(int)); /* unchanged */
	}
	assert_int_equal(view_resolve(&(struct view){.squash = 1}, 0, 240, NULL), -EINVAL);
}
