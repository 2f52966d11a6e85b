/* SPDX-License-Identifier: MIT */
/* People before the object: against double precision; where they are and are not, to the bit. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/basis/random_frame.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

/* A scene with object, ground, stand-ins and glass, and planes for a veil of its size. */
struct veiled {
	struct synthetic s;
	struct random_frame f;
	int width, height;
	uint8_t *tile, *front, *anybody, *foremost;
	struct veil veil;
	struct compositor_settings settings;
};

static void veiled_begin(struct veiled *v, int width, int height, struct pool *pool,
			 struct chance *chance)
{
	const struct synthetic_options options = {
		.width = width,
		.height = height,
		.lights = 12,
		.grounds = 1,
		.columns = -1,
		.object_share = 0.6,
		.ground_share = 0.5,
		.stand_in_share = 0.2,
		.glass_share = 0.3,
		.peak = 0.3,
		.bounce = 0.2,
		.seed = (uint64_t)width,
	};
	const size_t pixels = (size_t)width * (size_t)height;

	memset(v, 0, sizeof(*v));
	synthetic_open(&v->s, &options);
	v->width = width;
	v->height = height;
	v->tile = calloc((size_t)(v->s.basis.tiles_across * v->s.basis.tiles_down), 1);
	v->front = calloc(pixels, 1);
	v->anybody = calloc(pixels, 1);
	v->foremost = calloc(pixels, 4);
	assert_true(v->tile && v->front && v->anybody && v->foremost);
	v->veil = (struct veil){v->tile, v->front, v->anybody, v->foremost};
	v->settings = (struct compositor_settings){
		.background = {.named = TRANSFER_SRGB},
		.output = {.named = TRANSFER_SRGB},
		.gain = 1,
		.object = true,
		.veil = &v->veil,
	};
	random_frame_begin(&v->f, &v->s.basis, pool, chance);
}

static void veiled_end(struct veiled *v)
{
	random_frame_end(&v->f);
	synthetic_close(&v->s);
	free(v->tile);
	free(v->front);
	free(v->anybody);
	free(v->foremost);
}

static int tile_of(const struct veiled *v, int x, int y)
{
	return y / BASIS_TILE * v->s.basis.tiles_across + x / BASIS_TILE;
}

/* People in every second tile or so: nobody, somebody behind, somebody in front, and the edge. */
static void veiled_fill(struct veiled *v, struct chance *chance)
{
	for (int t = 0; t < v->s.basis.tiles_across * v->s.basis.tiles_down; t++)
		v->tile[t] = (uint8_t)chance_int(chance, 0, 1);
	for (size_t p = 0; p < (size_t)v->width * (size_t)v->height; p++) {
		const int front = chance_int(chance, -255, 510);

		v->front[p] = (uint8_t)(front < 0 ? 0 : front > 255 ? 255 : front);
		v->anybody[p] = (uint8_t)chance_int(chance, v->front[p], 255);
		for (size_t c = 0; c < 3; c++)
			v->foremost[4 * p + c] = (uint8_t)chance_int(chance, 0, 255);
	}
}

static void veiled_run(struct veiled *v, const struct veil *veil)
{
	struct compositor_settings settings = v->settings;

	settings.veil = veil;
	compositor_set(v->f.compositor, &settings);
	random_frame_run(&v->f, 0);
}

TEST("agrees with double precision")
{
	struct chance chance = chance_begin("veil");
	double most = 0;

	for (int width = 1; width <= 50; width++) {
		const int height = 1 + width * 7 % 33;
		double *exact = calloc((size_t)(width * height * 3), sizeof(*exact));
		struct veiled v;

		assert_non_null(exact);
		veiled_begin(&v, width, height, NULL, &chance);
		veiled_fill(&v, &chance);
		veiled_run(&v, &v.veil);
		assert_int_equal(compositor_reference(&v.s.basis, 0, &v.settings, &v.f.lights,
						      &v.f.picture, exact),
				 0);
		for (int p = 0; p < width * height; p++) {
			const uint8_t *out = v.f.out + (size_t)(p / width) * v.f.stride +
					     (size_t)(p % width) * 4;

			for (int c = 0; c < 3; c++)
				most = fmax(most, fabs(out[2 - c] - exact[3 * p + c]));
		}
		veiled_end(&v);
		free(exact);
	}
	print_message("# farthest from double precision: %.3f levels\n", most);
	assert_true(most < 1.5); /* the background of an edge is rounded once more */
}

/* Where nobody is, the bytes are those of a frame without people; where somebody hides the object,
 * those of the camera. */
TEST("changes only what is hidden")
{
	struct chance chance = chance_begin("veil");
	struct veiled v;
	uint8_t *bare;

	veiled_begin(&v, 61, 45, NULL, &chance);
	veiled_run(&v, NULL);
	bare = malloc(v.f.bytes);
	assert_non_null(bare);
	memcpy(bare, v.f.out, v.f.bytes);
	veiled_fill(&v, &chance);
	veiled_run(&v, &v.veil);
	for (int y = 0; y < v.height; y++)
		for (int x = 0; x < v.width; x++) {
			const int p = y * v.width + x;
			const size_t at = (size_t)y * v.f.stride + (size_t)x * 4;

			if (!v.tile[tile_of(&v, x, y)] || !v.anybody[p])
				expect_that(memcmp(v.f.out + at, bare + at, 4) == 0,
					    "nobody is at %d, %d", x, y);
			else if (v.front[p] == 255)
				expect_that(memcmp(v.f.out + at, v.f.background + at, 3) == 0,
					    "somebody is in front at %d, %d", x, y);
		}
	free(bare);
	veiled_end(&v);
}

TEST("same bytes by threads")
{
	struct chance one = chance_begin("veil"), other = one;
	struct veiled a, b;
	struct pool *pool;

	assert_int_equal(pool_create(&pool, 3), 0);
	veiled_begin(&a, 133, 70, NULL, &one);
	veiled_fill(&a, &one);
	veiled_run(&a, &a.veil);
	veiled_begin(&b, 133, 70, pool, &other);
	veiled_fill(&b, &other);
	veiled_run(&b, &b.veil);
	expect_same_picture(b.f.out, a.f.out, a.f.stride, a.f.bytes, "three threads and one");
	veiled_end(&a);
	veiled_end(&b);
	pool_destroy(pool);
}
