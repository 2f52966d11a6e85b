/* SPDX-License-Identifier: MIT */
/* An object that flickers with its rows: against double precision; the ground and what is seen
 * through the object, which have their rows already, stay to the bit. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/compositor/live/lit_rows.h"
#include "tests/support/basis/random_frame.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

enum { MOST_ROWS = 64 };

/* A scene with object, ground and glass. */
struct lit {
	struct synthetic s;
	struct random_frame f;
	int32_t rows[MOST_ROWS][3];
	struct compositor_settings settings;
};

static void lit_begin(struct lit *l, int width, int height, double object, struct pool *pool,
		      struct chance *chance)
{
	const struct synthetic_options options = {
		.width = width,
		.height = height,
		.lights = 12,
		.grounds = 1,
		.columns = -1,
		.object_share = object,
		.ground_share = 0.5,
		.stand_in_share = 0.2,
		.glass_share = object / 2,
		.peak = 0.3,
		.bounce = 0.2,
		.seed = (uint64_t)width,
	};

	memset(l, 0, sizeof(*l));
	synthetic_open(&l->s, &options);
	for (int y = 0; y < height; y++)
		for (int c = 0; c < 3; c++)
			l->rows[y][c] = chance_int(chance, 0, 2 * LIT_ROWS_ONE);
	l->settings = (struct compositor_settings){
		.background = {.named = TRANSFER_SRGB},
		.output = {.named = TRANSFER_SRGB},
		.gain = 1,
		.object = true,
		.rows = (const int32_t(*)[3])l->rows,
	};
	random_frame_begin(&l->f, &l->s.basis, pool, chance);
}

static void lit_end(struct lit *l)
{
	random_frame_end(&l->f);
	synthetic_close(&l->s);
}

static void lit_run(struct lit *l, bool rows)
{
	struct compositor_settings settings = l->settings;

	settings.rows = rows ? settings.rows : NULL;
	compositor_set(l->f.compositor, &settings);
	random_frame_run(&l->f, 0);
}

TEST("agrees with double precision")
{
	struct chance chance = chance_begin("rows");
	double most = 0;

	for (int width = 1; width <= 50; width++) {
		const int height = 1 + width * 7 % 33;
		double *exact = calloc((size_t)(width * height * 3), sizeof(*exact));
		struct lit l;

		assert_non_null(exact);
		lit_begin(&l, width, height, 0.6, NULL, &chance);
		lit_run(&l, true);
		assert_int_equal(compositor_reference(&l.s.basis, 0, &l.settings, &l.f.lights,
						      &l.f.picture, exact),
				 0);
		for (int p = 0; p < width * height; p++) {
			const uint8_t *out = l.f.out + (size_t)(p / width) * l.f.stride +
					     (size_t)(p % width) * 4;

			for (int c = 0; c < 3; c++)
				most = fmax(most, fabs(out[2 - c] - exact[3 * p + c]));
		}
		lit_end(&l);
		free(exact);
	}
	print_message("# farthest from double precision: %.3f levels\n", most);
	assert_true(most < 0.8);
}

/* Rows of 1 change nothing, and rows of anything nothing of a picture without an object; the object
 * does change. */
TEST("changes the object alone")
{
	static const double object[] = {0, 0.6};
	struct chance chance = chance_begin("rows");

	for (int k = 0; k < 2; k++) {
		struct lit l;
		uint8_t *bare;

		lit_begin(&l, 61, 45, object[k], NULL, &chance);
		lit_run(&l, false);
		bare = malloc(l.f.bytes);
		assert_non_null(bare);
		memcpy(bare, l.f.out, l.f.bytes);
		lit_run(&l, true);
		if (k == 0)
			expect_same_picture(l.f.out, bare, l.f.stride, l.f.bytes, "no object");
		else
			assert_true(memcmp(l.f.out, bare, l.f.bytes) != 0);
		for (int y = 0; y < 45; y++)
			for (int c = 0; c < 3; c++)
				l.rows[y][c] = LIT_ROWS_ONE;
		lit_run(&l, true);
		expect_same_picture(l.f.out, bare, l.f.stride, l.f.bytes, "rows of 1");
		free(bare);
		lit_end(&l);
	}
}

TEST("same bytes by threads")
{
	struct chance one = chance_begin("rows"), other = one;
	struct lit a, b;
	struct pool *pool;

	assert_int_equal(pool_create(&pool, 3), 0);
	lit_begin(&a, 133, 60, 0.6, NULL, &one);
	lit_run(&a, true);
	lit_begin(&b, 133, 60, 0.6, pool, &other);
	lit_run(&b, true);
	expect_same_picture(b.f.out, a.f.out, a.f.stride, a.f.bytes, "three threads and one");
	lit_end(&a);
	lit_end(&b);
	pool_destroy(pool);
}

/* Values at the limit stay there. */
TEST("values are clamped")
{
	static int32_t values[3][BASIS_TILE * BASIS_TILE];
	static const int32_t rows[2][3] = {{4 * LIT_ROWS_ONE, 32768, 0},
					   {LIT_ROWS_ONE + 1, 65537, 1}};
	const int32_t most = INT32_C(127) << 24;

	for (int c = 0; c < 3; c++)
		for (int p = 0; p < BASIS_TILE * BASIS_TILE; p++)
			values[c][p] = p % 2 ? -most : most - p / 2 % 2;
	lit_rows_apply(values, rows, 2);
	assert_int_equal(values[0][0], most);
	assert_int_equal(values[0][1], -most);
	assert_int_equal(values[1][0], most / 2);
	assert_int_equal(values[1][2], most / 2); /* of most - 1: halves go up */
	assert_int_equal(values[2][0], 0);
	assert_int_equal(values[0][BASIS_TILE], most);
	assert_int_equal(values[2][BASIS_TILE], (most + 32768) >> 16);
	assert_int_equal(values[0][2 * BASIS_TILE + 1], -most); /* beyond the tile's height */
}
