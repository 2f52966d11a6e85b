/* SPDX-License-Identifier: MIT */
/* The background seen through the object: against double precision at every offset and
 * transmission, against closed forms, and proof that neither threads nor a background that is made
 * piece by piece change a byte. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/basis/random_frame.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

static struct synthetic_options see_through(int width, int height, uint64_t seed)
{
	return (struct synthetic_options){
		.width = width,
		.height = height,
		.lights = 12,
		.grounds = 1,
		.columns = -1,
		.exact = true,
		.object_share = 0.6,
		.ground_share = 0.5,
		.stand_in_share = 0.2,
		.glass_share = 0.7,
		.peak = 0.3,
		.bounce = 2,
		.seed = seed,
	};
}

static const struct compositor_settings plain = {
	.background = {.named = TRANSFER_SRGB},
	.output = {.named = TRANSFER_SRGB},
	.gain = 1,
	.object = true,
};

static double farthest_of(const struct synthetic *s, uint64_t seed)
{
	const int width = (int)s->basis.info.width, height = (int)s->basis.info.height;
	double *exact = calloc((size_t)width * (size_t)height * 3, sizeof(*exact));
	struct chance chance = {seed};
	double most = 0;
	struct random_frame f;

	assert_non_null(exact);
	random_frame_begin(&f, &s->basis, NULL, &chance);
	compositor_set(f.compositor, &plain);
	random_frame_run(&f, 0);
	assert_int_equal(compositor_reference(&s->basis, 0, &plain, &f.lights, &f.picture, exact),
			 0);
	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++)
			for (int c = 0; c < 3; c++)
				most = fmax(most, fabs(f.out[(size_t)y * f.stride + (size_t)x * 4 +
							     2 - (size_t)c] -
						       exact[3 * (y * width + x) + c]));
	random_frame_end(&f);
	free(exact);
	return most;
}

/* All widths, so that tiles are cut everywhere and offsets lead out of the picture on every side.
 */
TEST("agrees with double precision")
{
	double most = 0;

	for (int width = 1; width <= 65; width++) {
		const struct synthetic_options options = see_through(width, 1 + width * 7 % 33,
								     (uint64_t)width);
		struct synthetic s;

		synthetic_open(&s, &options);
		most = fmax(most, farthest_of(&s, 99 + (uint64_t)width));
		synthetic_close(&s);
	}
	print_message("# farthest from double precision: %.3f levels\n", most);
	assert_true(most < 1);
}

/* ---- closed forms ---- */

#define SIDE 20

/* Writes a file whose object covers all and gives off no light, and is glass at these pixels. */
static void open_glass(struct synthetic *s, const struct basis_glass *glass, size_t count)
{
	const struct basis_info_chunk info = {
		.width = SIDE, .height = SIDE, .lights = 1, .poses = 1, .coarse = 1};
	const struct basis_light light = {{0, 0, 1}, 6};
	static const float peak[2][3];
	static uint16_t coverage[SIDE * SIDE];
	struct basis_writer *writer;
	struct fault fault = {""};

	memset(s, 0, sizeof(*s));
	memset(coverage, 255, sizeof(coverage));
	strcpy(s->folder, "/tmp/inlay-basis-XXXXXX");
	assert_non_null(mkdtemp(s->folder));
	snprintf(s->path, sizeof(s->path), "%s/b.inlay", s->folder);
	assert_int_equal(basis_writer_open(&writer, s->path, &info, &light, NULL, NULL, "", &fault),
			 0);
	assert_int_equal(basis_writer_glass(writer, glass, count, &fault), -EINVAL);
	assert_int_equal(basis_writer_pose_end(writer, coverage, peak, &fault), 0);
	assert_int_equal(basis_writer_glass(writer, glass, 0, &fault), -EINVAL);
	assert_int_equal(basis_writer_glass(writer, glass, count, &fault), 0);
	assert_int_equal(basis_writer_glass(writer, glass, count, &fault), -EINVAL);
	assert_int_equal(basis_writer_finish(writer, &info, "", &fault), 0);
	assert_int_equal(basis_open(&s->basis, s->path, BASIS_SHOWN, &fault), 0);
	assert_int_equal(s->basis.poses[0].glass_count, count);
}

TEST("shows the place it says")
{
	static const struct basis_glass glass[] = {
		{2, 1, {65535, 65535, 65535}, 0, 0, {0, 0}},	       /* straight and clear */
		{3, 1, {65535, 65535, 65535}, 16 * 5, 16 * 9, {0, 0}}, /* whole pixels */
		{4, 1, {65535, 65535, 65535}, -32768, 32767, {0, 0}},  /* beyond the edge */
		{5, 1, {0, 65535, 0}, 0, 0, {0, 0}},
		{6, 1, {65535, 65535, 65535}, 8, 0, {0, 0}}, /* between two pixels */
	};
	struct chance chance = {3};
	struct synthetic s;
	struct random_frame f;
	const uint8_t *row, *in;

	open_glass(&s, glass, sizeof(glass) / sizeof(*glass));
	random_frame_begin(&f, &s.basis, NULL, &chance);
	compositor_set(f.compositor, &plain);
	random_frame_run(&f, 0);
	row = f.out + f.stride;
	in = f.background;
	assert_memory_equal(row + 4 * 2, in + f.stride + 4 * 2, 3);
	assert_memory_equal(row + 4 * 3, in + 10 * f.stride + 4 * 8, 3);
	assert_memory_equal(row + 4 * 4, in + (SIDE - 1) * f.stride, 3);
	assert_int_equal(row[4 * 5], 0);
	assert_int_equal(row[4 * 5 + 1], in[f.stride + 4 * 5 + 1]);
	assert_int_equal(row[4 * 5 + 2], 0);
	for (int c = 0; c < 3; c++) {
		const uint8_t *pair = in + f.stride + 4 * 6 + c;
		const double mean = (transfer_decode(TRANSFER_SRGB, pair[0] / 255.0) +
				     transfer_decode(TRANSFER_SRGB, pair[4] / 255.0)) /
				    2;

		expect_below(fabs(row[4 * 6 + c] - 255 * transfer_encode(TRANSFER_SRGB, mean)), 1,
			     "channel %d", c);
	}
	assert_int_equal(row[4 * 7] + row[4 * 7 + 1] + row[4 * 7 + 2], 0);
	random_frame_end(&f);
	synthetic_close(&s);
}

/* ---- nothing but the light decides ---- */

static void make_part(const void *context, int x, int y, int width, int height, uint8_t *out,
		      size_t out_stride)
{
	const struct random_frame *f = context;

	assert_int_equal(x % BASIS_TILE, 0);
	assert_int_equal(y % BASIS_TILE, 0);
	for (int v = 0; v < height; v++)
		memcpy(out + (size_t)v * out_stride,
		       f->background + (size_t)(y + v) * f->stride + (size_t)x * 4,
		       (size_t)width * 4);
}

TEST("threads and made backgrounds change nothing")
{
	const struct synthetic_options options = see_through(300, 70, 4);
	struct chance chance = {8};
	struct backdrop made = {.width = 300, .height = 70, .make = make_part};
	struct random_frame one, f;
	struct synthetic s;
	struct pool *pool;

	synthetic_open(&s, &options);
	assert_int_equal(pool_create(&pool, 3), 0);
	random_frame_begin(&one, &s.basis, NULL, &chance);
	chance.state = 8;
	random_frame_begin(&f, &s.basis, pool, &chance);
	assert_memory_equal(one.background, f.background, f.bytes);
	for (int mode = 0; mode < COMPOSITOR_MODE_COUNT; mode++) {
		struct compositor_settings settings = plain;

		settings.mode = (enum compositor_mode)mode;
		compositor_set(one.compositor, &settings);
		compositor_set(f.compositor, &settings);
		random_frame_run(&one, 0);
		random_frame_run(&f, 0);
		expect_same_picture(f.out, one.out, f.stride, f.bytes, "threads, mode %d", mode);
		made.context = &f;
		memset(f.out, 0x5a, f.bytes);
		assert_int_equal(compositor_run(f.compositor, 0, &f.lights, &made, f.out, f.stride),
				 0);
		expect_same_picture(f.out, one.out, f.stride, f.bytes,
				    "made background, threads, mode %d", mode);
		memset(f.out, 0x5a, f.bytes);
		assert_int_equal(
			compositor_run(one.compositor, 0, &f.lights, &made, f.out, f.stride), 0);
		expect_same_picture(f.out, one.out, f.stride, f.bytes, "made background, mode %d",
				    mode);
	}
	random_frame_end(&one);
	random_frame_end(&f);
	pool_destroy(pool);
	synthetic_close(&s);
}
