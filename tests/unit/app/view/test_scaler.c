/* SPDX-License-Identifier: MIT */
/* Scaling pictures: against the filter in double precision, and properties of any scaler. */
#include <math.h>
#include <string.h>

#include "app/view/layout.h"
#include "hal/frame/frame.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

static struct canvas noise(struct chance *chance, int width, int height)
{
	struct canvas canvas;

	assert_int_equal(canvas_create(&canvas, width, height), 0);
	for (int y = 0; y < height; y++) {
		for (int x = 0; x < 4 * width; x++)
			canvas.pixels[(size_t)y * canvas.stride + (size_t)x] =
				(uint8_t)(x % 4 == 3 ? 255 : chance_int(chance, 0, 255));
	}
	return canvas;
}

static struct picture whole(const struct canvas *canvas, bool hflip, bool vflip)
{
	struct view view = {.width = canvas->width,
			    .height = canvas->height,
			    .hflip = hflip,
			    .vflip = vflip,
			    .squash = 1};

	return view_picture(&view, canvas->pixels, canvas->stride);
}

static double value(const struct picture *p, int x, int y, int c)
{
	return p->origin[x * p->x_step + y * p->y_step + c];
}

/* Weight of the tent filter at destination i and source s, not normalised. */
static double tent(int from, int to, int i, int s)
{
	double scale = (double)from / to, reach = fmax(1, scale);

	return fmax(0, 1 - fabs(s - ((i + 0.5) * scale - 0.5)) / reach);
}

static double filtered(const struct picture *p, int to_width, int to_height, int x, int y, int c)
{
	double sum = 0, weights = 0;

	for (int sy = 0; sy < p->height; sy++) {
		double wy = tent(p->height, to_height, y, sy);

		for (int sx = 0; wy > 0 && sx < p->width; sx++) {
			double w = wy * tent(p->width, to_width, x, sx);

			sum += w * value(p, sx, sy, c);
			weights += w;
		}
	}
	return sum / weights;
}

static void scale(const struct picture *from, struct canvas *to, struct pool *pool)
{
	struct scaler scaler = {.scratch = NULL};

	assert_int_equal(
		scaler_fit(&scaler, from->width, from->height, to->width, to->height, pool), 0);
	scaler_run(&scaler, pool, from, 0, to->width, to->pixels, to->stride);
	scaler_free(&scaler);
	scaler_free(&scaler);
}

/* Two roundings to 8 bits and weights of 14 bits: within 1.5 levels of the exact filter. */
TEST("is the filter it says")
{
	struct chance chance = chance_begin("is_the_filter_it_says");

	for (int run = 0; run < 60; run++) {
		struct canvas from = noise(&chance, chance_int(&chance, 1, 23),
					   chance_int(&chance, 1, 23));
		struct canvas to = noise(&chance, chance_int(&chance, 1, 40),
					 chance_int(&chance, 1, 40));
		struct picture picture = whole(&from, run % 2, run / 2 % 2);

		scale(&picture, &to, NULL);
		for (int y = 0; y < to.height; y++) {
			for (int x = 0; x < to.width; x++) {
				for (int c = 0; c < 4; c++) {
					double exact = filtered(&picture, to.width, to.height, x, y,
								c);
					int is = to.pixels[(size_t)y * to.stride + 4 * (size_t)x +
							   (size_t)c];

					expect_below(fabs(is - exact), 1.5,
						     "run=%d, y=%d, x=%d, c=%d", run, y, x, c);
				}
			}
		}
		canvas_free(&from);
		canvas_free(&to);
	}
}

TEST("equal sizes are a copy")
{
	struct chance chance = chance_begin("equal_sizes_are_a_copy");
	struct canvas from = noise(&chance, 37, 11), to = noise(&chance, 37, 11);

	for (int flips = 0; flips < 4; flips++) {
		struct picture picture = whole(&from, flips & 1, flips & 2);

		scale(&picture, &to, NULL);
		for (int y = 0; y < 11; y++) {
			for (int x = 0; x < 37; x++)
				expect_same_picture(
					to.pixels + (size_t)y * to.stride + 4 * (size_t)x,
					picture.origin + x * picture.x_step + y * picture.y_step, 4,
					4, "of the pixel at (%d, %d), flips %d", x, y, flips);
		}
	}
	canvas_free(&from);
	canvas_free(&to);
}

/* A flat picture stays flat to the last bit at any size. */
TEST("flat stays flat")
{
	static const int sizes[] = {1, 2, 3, 7, 64, 65, 243, 486};

	for (size_t a = 0; a < sizeof(sizes) / sizeof(*sizes); a++) {
		for (size_t b = 0; b < sizeof(sizes) / sizeof(*sizes); b++) {
			struct canvas from, to;
			struct picture picture;

			assert_int_equal(canvas_create(&from, sizes[a], sizes[b]), 0);
			assert_int_equal(canvas_create(&to, sizes[b], sizes[a]), 0);
			memset(from.pixels, 201, from.stride * (size_t)from.height);
			picture = whole(&from, false, false);
			scale(&picture, &to, NULL);
			for (int y = 0; y < to.height; y++) {
				for (int x = 0; x < 4 * to.width; x++)
					expect_equal(to.pixels[(size_t)y * to.stride + (size_t)x],
						     201, "a=%zu, b=%zu, y=%d, x=%d", a, b, y, x);
			}
			canvas_free(&from);
			canvas_free(&to);
		}
	}
}

TEST("threads change nothing")
{
	struct chance chance = chance_begin("threads_change_nothing");
	struct canvas from = noise(&chance, 101, 57), one = noise(&chance, 233, 199),
		      many = noise(&chance, 233, 199);
	struct picture picture = whole(&from, true, false);
	struct pool *pool;

	assert_int_equal(pool_create(&pool, 4), 0);
	scale(&picture, &one, NULL);
	scale(&picture, &many, pool);
	for (int y = 0; y < one.height; y++)
		expect_same_picture(many.pixels + (size_t)y * many.stride,
				    one.pixels + (size_t)y * one.stride, many.stride,
				    4 * (size_t)one.width, "row %d", y);
	pool_destroy(pool);
	canvas_free(&from);
	canvas_free(&one);
	canvas_free(&many);
}

/* Columns made alone are the same as in the whole picture, and nothing beside them is written. */
TEST("columns are those of the whole")
{
	struct chance chance = chance_begin("columns_are_those_of_the_whole");

	for (int run = 0; run < 60; run++) {
		struct canvas from = noise(&chance, chance_int(&chance, 1, 40),
					   chance_int(&chance, 1, 40));
		struct canvas all = noise(&chance, chance_int(&chance, 1, 70),
					  chance_int(&chance, 1, 70));
		int left = chance_int(&chance, 0, all.width);
		int right = chance_int(&chance, left, all.width);
		struct picture picture = whole(&from, run % 2, run / 2 % 2);
		struct scaler scaler = {.scratch = NULL};
		uint8_t out[70][72][4];

		scale(&picture, &all, NULL);
		memset(out, 77, sizeof(out));
		assert_int_equal(
			scaler_fit(&scaler, from.width, from.height, all.width, all.height, NULL),
			0);
		scaler_run(&scaler, NULL, &picture, left, right, out[0][1], sizeof(out[0]));
		for (int y = 0; y < all.height; y++) {
			const uint8_t *row = all.pixels + (size_t)y * all.stride;
			int end = 1 + right - left;

			expect_same_picture(out[y][1], row + 4 * left, sizeof(out[0]),
					    4 * (size_t)(right - left),
					    "row %d, columns %d to %d, run %d", y, left, right,
					    run);
			expect_equal(out[y][0][3], 77, "run=%d, y=%d", run, y);
			expect_equal(out[y][end][0], 77, "run=%d, y=%d", run, y);
		}
		scaler_free(&scaler);
		canvas_free(&from);
		canvas_free(&all);
	}
}

/* Nothing outside the rectangle is written. */
TEST("writes no further")
{
	struct chance chance = chance_begin("writes_no_further");
	struct canvas from = noise(&chance, 9, 9);
	struct picture picture = whole(&from, false, false);
	struct scaler scaler = {.scratch = NULL};
	uint8_t out[40 * 200];

	memset(out, 77, sizeof(out));
	assert_int_equal(scaler_fit(&scaler, 9, 9, 30, 30, NULL), 0);
	scaler_run(&scaler, NULL, &picture, 0, 30, out + 5 * 200 + 8, 200);
	for (int y = 0; y < 40; y++) {
		for (int x = 0; x < 200; x++) {
			if (y < 5 || y >= 35 || x < 8 || x >= 8 + 120)
				expect_equal(out[y * 200 + x], 77, "y=%d, x=%d", y, x);
		}
	}
	scaler_free(&scaler);
	canvas_free(&from);
}

/* A pool with more threads than the one the scaler was prepared for: each thread has its own
 * scratch memory. */
TEST("has room for more threads")
{
	struct chance chance = chance_begin("has_room_for_more_threads");
	struct canvas from = noise(&chance, 40, 300), to = noise(&chance, 50, 290);
	struct picture picture = whole(&from, false, false);
	struct scaler scaler = {.scratch = NULL};
	struct pool *pool;

	assert_int_equal(pool_create(&pool, 5), 0);
	assert_int_equal(scaler_fit(&scaler, 40, 300, 50, 290, NULL), 0);
	assert_int_equal(scaler.workers, 1);
	assert_int_equal(scaler_fit(&scaler, 40, 300, 50, 290, pool), 0);
	assert_int_equal(scaler.workers, 5);
	scaler_run(&scaler, pool, &picture, 0, 50, to.pixels, to.stride);
	scaler_free(&scaler);
	pool_destroy(pool);
	canvas_free(&from);
	canvas_free(&to);
}
