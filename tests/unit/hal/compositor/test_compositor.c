/* SPDX-License-Identifier: MIT */
/* The compositor: its formula against closed forms, and proof that only the light decides a
 * picture, not threads, kernels or the way in which the background is read. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/compositor/kernels/kernels.h"
#include "tests/support/basis/random_frame.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

static struct light_selection selection_of(int count)
{
	struct light_selection s = {.count = count};

	s.radiance = calloc((size_t)count, sizeof(*s.radiance));
	s.used = calloc((size_t)count, sizeof(*s.used));
	assert_true(s.radiance && s.used);
	return s;
}

/* ---- selection ---- */

static const struct synthetic_options plain = {
	.width = 40,
	.height = 23,
	.lights = 26,
	.grounds = 2,
	.coarse = 12,
	.patterns = 3,
	.columns = 11,
	.layers = 2,
	.vary = true,
	.exact = true,
	.object_share = 0.4,
	.ground_share = 0.3,
	.stand_in_share = 0.2,
	.peak = 1,
	.bounce = 0.3,
	.seed = 11,
};

TEST("selection keeps what reaches the threshold")
{
	struct synthetic *s = *state;
	struct light_selection sel;
	float radiance[26][3] = {{0}};
	double power = 0;

	for (int i = 0; i < 26; i++)
		radiance[i][i % 3] = (float)i;
	radiance[25][0] = NAN;
	radiance[25][1] = -1; /* [1] was 25 before */
	radiance[24][0] = INFINITY;
	assert_int_equal(light_selection_create(&sel, &s->basis), 0);
	light_selection_choose(&sel, &s->basis, 0, (const float(*)[3])radiance, 10,
			       THRESHOLD_AMBIENT, 2);
	assert_int_equal(sel.used_count, 14); /* lights 10 to 23 */
	for (int i = 0; i < 26; i++) {
		expect_equal(sel.used[i], i >= 10 && i < 24, "light %d", i);
		for (int c = 0; c < 3; c++)
			expect_equal(sel.radiance[i][c], sel.used[i] && i % 3 == c ? i : 0,
				     "light %d, channel %d", i, c);
	}
	for (int i = 0; i < 10; i += 3)
		power += i * s->basis.lights[i].solid_angle_sr;
	assert_true(fabs(sel.ambient[0] - power / (2 * M_PI)) < 1e-12);
	light_selection_choose(&sel, &s->basis, 0, (const float(*)[3])radiance, 0, THRESHOLD_DROP,
			       2);
	assert_int_equal(sel.used_count, 26);
	assert_true(sel.ambient[0] == 0 && sel.dropped_error[0] == 0);
	light_selection_free(&sel);
	light_selection_free(&sel);
}

/* Checks the bound for dropped light against every value of the object in a file. */
TEST("dropped light errs no more than said")
{
	struct chance chance = chance_begin("dropped light");
	struct synthetic *s = *state;
	const struct basis_layer *layer = &s->basis.poses[0].shown;
	struct light_selection sel;
	double closest = 0;

	assert_int_equal(light_selection_create(&sel, &s->basis), 0);
	for (int k = 0; k < 40; k++) {
		const double gain = chance_real(&chance, 0, 3);
		float radiance[26][3];

		for (int i = 0; i < 26; i++)
			for (int c = 0; c < 3; c++)
				radiance[i][c] = (float)chance_real(&chance, 0, 1);
		light_selection_choose(&sel, &s->basis, 0, (const float(*)[3])radiance,
				       chance_real(&chance, 0, 1.2),
				       (enum threshold_mode)(k % THRESHOLD_MODE_COUNT), gain);
		for (int t = 0; t < 6; t++) {
			const struct basis_tile *tile = &layer->tiles[t];
			double *value = calloc(256 * 3 * 26, sizeof(*value));

			assert_non_null(value);
			for (int n = 0; n < tile->block_count; n++)
				if (tile->blocks[n].kind == BASIS_KIND_T)
					synthetic_add_values(&tile->blocks[n], 26, s->basis.coarse,
							     value);
			for (int r = 0; r < 256 * 3; r++) {
				const int c = r % 3;
				double off = 0;

				for (int i = 0; i < 26; i++)
					off += value[r * 26 + i] *
					       s->basis.lights[i].solid_angle_sr *
					       (sel.radiance[i][c] + sel.ambient[c] -
						(double)radiance[i][c]);
				off = fabs(off) * gain;
				expect_at_most(off, sel.dropped_error[c] * (1 + 1e-6) + 1e-12,
					       "lighting %d, pixel %d of tile %d, channel %d", k,
					       r / 3, t, c);
				closest = fmax(closest, off / (sel.dropped_error[c] + 1e-30));
			}
			free(value);
		}
	}
	assert_true(closest > 0.2); /* the bound is not much too large either */
	light_selection_free(&sel);
}

/* ---- one pixel, where the answer is known ---- */

struct one {
	struct basis basis;
	struct basis_pose pose;
	struct basis_tile tile;
	struct basis_block block[4];
	struct basis_light light[2];
	double ground[3][2];
	uint16_t coverage;
	float peak[3][3];
	int16_t pattern[4][32] __attribute__((aligned(64)));
	int16_t line[4][2 * 32] __attribute__((aligned(64)));
	float scale[4][2];
	uint16_t lists[2];
	bool patterns; /* blocks hold a pattern instead of columns */
};

static void one_begin(struct one *o)
{
	const bool patterns = o->patterns;

	memset(o, 0, sizeof(*o));
	o->patterns = patterns;
	o->lists[1] = 1;
	for (int i = 0; i < 2; i++) {
		o->light[i] = (struct basis_light){{0, 0, 1}, M_PI};
		for (int c = 0; c < 3; c++)
			o->ground[c][i] = i ? 3 : 1;
	}
	o->tile = (struct basis_tile){0, 0, 1, 1, o->block, 0, 0};
	o->pose = (struct basis_pose){.coverage = &o->coverage,
				      .peak = (const float(*)[3])o->peak,
				      .shown = {&o->tile, o->block, 0}};
	o->basis = (struct basis){.info = {.width = 1,
					   .height = 1,
					   .lights = 2,
					   .grounds = 1,
					   .poses = 1,
					   .coarse = 2},
				  .lights = o->light,
				  .ground = &o->ground[0][0],
				  .tiles_across = 1,
				  .tiles_down = 1,
				  .poses = &o->pose};
}

/* Adds a block of one pixel, one channel for all three, and two values per unit of L (kind V: of u
 * L). */
static void one_add(struct one *o, enum basis_kind kind, double first, double second)
{
	const double unit = kind == BASIS_KIND_V ? 1 : 1 / M_PI;
	const int n = o->tile.block_count++;
	const double value[2] = {first * unit, second * unit};
	const double most = fmax(fabs(value[0]), fabs(value[1]));
	struct basis_block *b = &o->block[n];

	o->pose.shown.block_count++;
	*b = (struct basis_block){.kind = kind,
				  .pixels = 1,
				  .channels = 1,
				  .bits = 16,
				  .stride = 32,
				  .pixel = o->lists,
				  .light = o->lists,
				  .pattern_scale = o->scale[n],
				  .column_scale = o->scale[n],
				  .cut_share = 1,
				  .pattern = o->pattern[n],
				  .coefficient = o->line[n],
				  .column16 = o->line[n]};
	for (int i = 0; i < 2; i++) {
		o->scale[n][i] = (float)(o->patterns ? most / 32767 / 32767
						     : fabs(value[i]) / 32767);
		o->pattern[n][i] = (int16_t)lrint(most > 0 ? value[i] / most * 32767 : 0);
		o->line[n][32 * i] = (int16_t)(value[i] < 0 && !o->patterns ? -32767 : 32767);
	}
	b->patterns = o->patterns;
	b->columns = o->patterns ? 0 : 2;
}

/* Checks compositor and reference on one pixel of background 128. Linear light, 0..1. */
static void one_expect(struct one *o, double first, double second, double ambient, double gain,
		       double expected)
{
	const struct compositor_settings settings = {.background = {.named = TRANSFER_LINEAR},
						     .output = {.named = TRANSFER_LINEAR},
						     .gain = gain,
						     .object = true};
	const struct compositor_options options = {.kernel = "c"};
	const uint8_t background[4] = {128, 128, 128, 0};
	const struct picture picture = {background, 4, 4, 1, 1};
	const struct backdrop backdrop = backdrop_of(&picture);
	struct light_selection sel = selection_of(2);
	struct compositor *compositor;
	uint8_t out[4];
	double exact[3];

	for (int c = 0; c < 3; c++) {
		sel.radiance[0][c] = first;
		sel.radiance[1][c] = second;
		sel.ambient[c] = ambient;
	}
	assert_int_equal(compositor_create(&compositor, &o->basis, &options, NULL), 0);
	compositor_set(compositor, &settings);
	assert_int_equal(compositor_run(compositor, 0, &sel, &backdrop, out, 4), 0);
	assert_int_equal(compositor_reference(&o->basis, 0, &settings, &sel, &picture, exact), 0);
	for (int c = 0; c < 3; c++) {
		expect_below(fabs(exact[c] / 255 - expected), 2e-4,
			     "reference, channel %d, light %g and %g, rest %g", c, first, second,
			     ambient);
		expect_below(fabs(out[c] / 255.0 - expected), 0.6 / 255,
			     "channel %d, light %g and %g, rest %g", c, first, second, ambient);
	}
	assert_int_equal(out[3], 255);
	compositor_destroy(compositor);
	light_selection_free(&sel);
}

static void closed_forms(struct one *one)
{
	const double b = 128 / 255.0;
	one_begin(one); /* nothing there: the background is shown */
	one_expect(one, 1, 1, 0, 1, b);

	one_begin(one); /* an opaque object: 0.25 * 1 + 0.5 * 0.5, twice */
	one->coverage = 65535;
	one_add(one, BASIS_KIND_T, 0.25, 0.5);
	one_expect(one, 1, 0.5, 0, 1, 0.5);
	one_expect(one, 0.5, 0.25, 0, 2, 0.5);
	one_expect(one, 0, 0, 0.4, 1, 0.3); /* ambient light over both */
	one_expect(one, 0.5, 0, 0.4, 1, 0.425);
	one_expect(one, 0, 0, 0, 1, 0);
	one_expect(one, 9, 9, 0, 1, 1); /* clipped */
	one_expect(one, 1, 1, 0, 0, 0); /* gain 0; then no object */

	one_begin(one); /* half covered by an object that gives off no light */
	one->coverage = 32768;
	one_expect(one, 1, 1, 0, 1, b / 2);

	one_begin(one); /* half covered, in shadow: 0.1 + 0.5 * 0.25 * b */
	one->coverage = 32768;
	one_add(one, BASIS_KIND_T, 0.1, 0);
	one_add(one, BASIS_KIND_V, 0, 1);
	one_expect(one, 1, 1, 0, 1, 0.1 + 0.5 * 0.25 * b);

	one_begin(one); /* light 1 (u = 3, of 4) is shadowed */
	one_add(one, BASIS_KIND_V, 0, 1);
	one_expect(one, 1, 1, 0, 1, 0.25 * b);
	one_expect(one, 1, 0, 0, 1, b);
	one_expect(one, 0, 1, 0, 1, 0);
	one_expect(one, 3, 1, 0, 1, 0.5 * b);
	one_expect(one, 0, 0, 0.5, 1, 0.25 * b);
	one_expect(one, 2, 0, 1, 1, 0.5 * b); /* the shadow takes (3 * 1) / (1 * 3 + 3 * 1) */
	one_expect(one, 1e6, 1e6, 0, 1, 0.25 * b);
	one_expect(one, 0, 0, 0, 1, b);			    /* 0/0 */
	one_expect(one, 0, 0x1p-20 * 4 / 3, 0, 1, 0.5 * b); /* as much light as e */

	one_begin(one); /* light 1 is shadowed, the other one adds half: u = 1 and 3 */
	one_add(one, BASIS_KIND_V, -0.5, 1);
	one_expect(one, 1, 1, 0, 1, (1 - 0.75 + 0.125) * b);
	one_expect(one, 1, 0, 0, 1, 1.5 * b);
	one_expect(one, 0, 1, 0, 1, 0);
	one_expect(one, 3, 1, 0, 1, 0.75 * b);
	one_expect(one, 0, 0, 0.5, 1, 0.375 * b);
	one_expect(one, 0, 0, 0, 1, b);

	one_begin(one); /* the same from two blocks: one of shadow, one of added light */
	one_add(one, BASIS_KIND_V, 0, 1);
	one_add(one, BASIS_KIND_V, -0.5, 0);
	one_expect(one, 1, 1, 0, 1, (1 - 0.75 + 0.125) * b);
	one_expect(one, 3, 1, 0, 1, 0.75 * b);

	one_begin(one); /* parts of an object, far beyond white, that cancel each other */
	one->coverage = 65535;
	one_add(one, BASIS_KIND_T, 100, 100);
	one_add(one, BASIS_KIND_T, -99.5, -99.5);
	one_expect(one, 1, 0, 0, 1, 0.5);
	one_expect(one, 1e9, 0, 0, 1, 1);

	one_begin(one); /* light that the object adds */
	one_add(one, BASIS_KIND_V, -0.5, -0.5);
	one_expect(one, 1, 1, 0, 1, 1.5 * b);

	one_begin(one); /* the ratio is at most 16: code 1 becomes 16 */
	one_add(one, BASIS_KIND_V, -500, -500);
	one_expect(one, 1, 1, 0, 1, 1);

	one_begin(one); /* a receiver with ground terms of its own: u = 1, 3 and d = 0, 3 */
	one_add(one, BASIS_KIND_D, 0, 3);
	one_add(one, BASIS_KIND_U, 1, 3);
	one_expect(one, 1, 1, 0, 1, 0.25 * b);
	one_expect(one, 1, 0, 0, 1, b);
	one_expect(one, 0, 0, 0.5, 1, 0.25 * b);
	one_expect(one, 1e6, 1e6, 0, 1, 0.25 * b);
	one_expect(one, 0, 0, 0, 1, b);
	one_expect(one, 0, 0x1p-20 * 4 / 3, 0, 1, 0.5 * b);

	one_begin(one); /* a receiver that no light reaches: unchanged, whatever d says */
	one_add(one, BASIS_KIND_D, 1, 3);
	one_add(one, BASIS_KIND_U, 0, 0);
	one_expect(one, 1, 1, 0, 1, b);
	one_expect(one, 0, 0, 0, 1, b);
}

TEST("formula gives the closed forms")
{
	static struct one one;

	for (int patterns = 0; patterns < 2; patterns++) {
		one.patterns = patterns;
		closed_forms(&one);
	}
}

/* k times the light gives k times the object, and the same shadow. */
TEST("brighter light scales the object alone")
{
	const double b = 128 / 255.0;
	static struct one object, shadow;

	one_begin(&object);
	object.coverage = 65535;
	one_add(&object, BASIS_KIND_T, 0.25, 0.5);
	one_begin(&shadow);
	one_add(&shadow, BASIS_KIND_V, 0, 1);
	for (double k = 1.0 / 4096; k <= 2; k *= 1.37) {
		one_expect(&object, k, k / 2, 0, 1, k / 2);
		one_expect(&object, k / 2, k / 4, k / 3, 1, k / 2);
		if (k > 0.05) /* in less light e has an effect */
			one_expect(&shadow, k, k, 0, 1, 0.25 * b);
		one_expect(&shadow, 1e5 * k, 3e5 * k, 0, 1, 0.1 * b);
	}
}

/* ---- pictures ---- */

TEST("background alone is copied")
{
	struct chance chance = chance_begin("background");
	struct synthetic *s = *state;
	struct random_frame f;

	random_frame_begin(&f, &s->basis, NULL, &chance);
	for (int pair = 0; pair < TRANSFER_COUNT * TRANSFER_COUNT; pair++) {
		const struct compositor_settings settings = {
			.background = {.named = (enum transfer)(pair / TRANSFER_COUNT)},
			.output = {.named = (enum transfer)(pair % TRANSFER_COUNT)},
			.gain = 1,
		};

		compositor_set(f.compositor, &settings);
		random_frame_run(&f, 0);
		for (size_t i = 0; i < f.bytes; i++) {
			const uint8_t in = f.background[i];

			if (i % f.stride >= f.stride - 4)
				expect_equal(f.out[i], 0x5a, "behind row %zu, curves %d",
					     i / f.stride, pair);
			else if (i % f.stride % 4 == 3)
				expect_equal(f.out[i], 255,
					     "fourth byte of pixel (%zu, %zu), curves %d",
					     i % f.stride / 4, i / f.stride, pair);
			else if (transfer_curve_same(&settings.background, &settings.output))
				expect_equal(f.out[i], in,
					     "pixel (%zu, %zu), channel %zu, curves %d",
					     i % f.stride / 4, i / f.stride, i % 4, pair);
			else
				expect_below(
					fabs(f.out[i] - 255 * transfer_curve_encode(
								      &settings.output,
								      transfer_curve_decode(
									      &settings.background,
									      in / 255.0))),
					0.53, "pixel (%zu, %zu), channel %zu, curves %d",
					i % f.stride / 4, i / f.stride, i % 4, pair);
		}
	}
	random_frame_end(&f);
}

TEST("untouched pixels are copied")
{
	struct chance chance = chance_begin("untouched");
	struct synthetic *s = *state;
	const struct basis_pose *pose = &s->basis.poses[0];
	bool touched[23][40] = {{false}};
	struct random_frame f;
	int copies = 0;

	for (int y = 0; y < 23; y++)
		for (int x = 0; x < 40; x++)
			touched[y][x] = pose->coverage[y * 40 + x] != 0;
	for (int t = 0; t < 6; t++) {
		const struct basis_tile *tile = &pose->shown.tiles[t];

		for (int n = 0; n < tile->block_count; n++)
			for (int p = 0; p < tile->blocks[n].pixels; p++)
				touched[tile->y + tile->blocks[n].pixel[p] / BASIS_TILE]
				       [tile->x + tile->blocks[n].pixel[p] % BASIS_TILE] = true;
	}
	random_frame_begin(&f, &s->basis, NULL, &chance);
	random_frame_run(&f, 0);
	for (size_t y = 0; y < 23; y++) {
		for (size_t x = 0; x < 40; x++) {
			if (touched[y][x])
				continue;
			expect_same_picture(f.out + y * f.stride + x * 4,
					    f.background + y * f.stride + x * 4, 4, 3,
					    "of the pixel at (%zu, %zu)", x, y);
			copies++;
		}
		expect_equal(f.out[y * f.stride + 160], 0x5a, "behind row %zu", y);
	}
	assert_true(copies > 50 && copies < 800);
	random_frame_end(&f);
}

TEST("flips are only reading order")
{
	struct chance chance = chance_begin("flips");
	struct synthetic *s = *state;
	struct random_frame f;
	uint8_t *flipped, *expected;

	random_frame_begin(&f, &s->basis, NULL, &chance);
	flipped = malloc(f.bytes);
	expected = malloc(f.bytes);
	assert_true(flipped && expected);
	for (int flip = 0; flip < 8; flip++) {
		const bool h = flip & 1, v = flip & 2;
		const struct compositor_settings settings = {.background = {.named = TRANSFER_SRGB},
							     .output = {.named = TRANSFER_SRGB},
							     .gain = 1,
							     .object = !(flip & 4)};
		const struct picture picture = {
			f.background + (h ? 39 * 4 : 0) + (v ? 22 * f.stride : 0), h ? -4 : 4,
			v ? -(ptrdiff_t)f.stride : (ptrdiff_t)f.stride, 40, 23};
		const struct picture upright = {flipped, 4, (ptrdiff_t)f.stride, 40, 23};

		for (size_t y = 0; y < 23; y++)
			for (size_t x = 0; x < 40; x++)
				memcpy(flipped + y * f.stride + x * 4,
				       f.background + (v ? 22 - y : y) * f.stride +
					       (h ? 39 - x : x) * 4,
				       4);
		const struct backdrop turned = backdrop_of(&picture),
				      straight = backdrop_of(&upright);

		compositor_set(f.compositor, &settings);
		memset(expected, 0x5a, f.bytes);
		assert_int_equal(
			compositor_run(f.compositor, 0, &f.lights, &straight, expected, f.stride),
			0);
		assert_int_equal(
			compositor_run(f.compositor, 0, &f.lights, &turned, f.out, f.stride), 0);
		expect_same_picture(f.out, expected, f.stride, f.bytes,
				    "flips: horizontal %d, vertical %d", h, v);
	}
	free(flipped);
	free(expected);
	random_frame_end(&f);
}

/* A file without D blocks needs no weights for them. */
TEST("a file without receivers is composited")
{
	struct synthetic_options o = plain;
	struct chance chance = {5};
	struct synthetic s;
	struct random_frame f;
	double *exact;

	o.stand_in_share = 0;
	synthetic_open(&s, &o);
	random_frame_begin(&f, &s.basis, NULL, &chance);
	exact = malloc(sizeof(*exact) * 3 * 40 * 23);
	assert_non_null(exact);
	random_frame_run(&f, 0);
	assert_int_equal(
		compositor_reference(&s.basis, 0,
				     &(struct compositor_settings){.gain = 1, .object = true},
				     &f.lights, &f.picture, exact),
		0);
	for (int i = 0; i < 40 * 23 * 3; i++)
		expect_below(fabs(f.out[(size_t)(i / 120) * f.stride + (size_t)(i / 3 % 40) * 4 +
					2 - (size_t)(i % 3)] -
				  exact[i]),
			     1, "pixel (%d, %d), channel %d", i / 3 % 40, i / 120, i % 3);
	free(exact);
	random_frame_end(&f);
	synthetic_close(&s);
}

TEST("threads do not change a byte")
{
	struct synthetic *s = *state;
	uint8_t *alone = NULL;

	for (int threads = 0; threads <= 4; threads++) {
		struct chance chance = {5};
		struct pool *pool = NULL;
		struct random_frame f;

		if (threads)
			assert_int_equal(pool_create(&pool, threads), 0);
		random_frame_begin(&f, &s->basis, pool, &chance);
		/* many frames, so that the work is divided anew twice */
		for (int frame = 0; frame < 70; frame++)
			random_frame_run(&f, 0);
		if (!alone) {
			alone = malloc(f.bytes);
			assert_non_null(alone);
			memcpy(alone, f.out, f.bytes);
		}
		expect_same_picture(f.out, alone, f.stride, f.bytes, "%d threads", threads);
		random_frame_end(&f);
		pool_destroy(pool);
	}
	free(alone);
}

TEST("kernels do not change a byte")
{
	struct synthetic *s = *state;
	int others = 0;

	for (int k = 0; kernels_all[k]; k++) {
		const struct compositor_options options = {.kernel = kernels_all[k]->name};
		struct chance chance = {5};
		struct compositor *other;
		struct random_frame f;
		uint8_t *out;

		if (!kernels_all[k]->supported())
			continue;
		random_frame_begin(&f, &s->basis, NULL, &chance);
		out = malloc(f.bytes);
		assert_non_null(out);
		memset(out, 0x5a, f.bytes);
		compositor_destroy(f.compositor);
		assert_int_equal(compositor_create(&f.compositor, &s->basis,
						   &(struct compositor_options){.kernel = "c"},
						   NULL),
				 0);
		assert_int_equal(compositor_create(&other, &s->basis, &options, NULL), 0);
		assert_string_equal(compositor_kernel(other), kernels_all[k]->name);
		for (int mode = 0; mode < COMPOSITOR_MODE_COUNT; mode++) {
			const struct compositor_settings settings = {
				.mode = (enum compositor_mode)mode, .gain = 1.3, .object = true};

			compositor_set(f.compositor, &settings);
			compositor_set(other, &settings);
			random_frame_run(&f, 0);
			assert_int_equal(
				compositor_run(other, 0, &f.lights, &f.backdrop, out, f.stride), 0);
			expect_same_picture(out, f.out, f.stride, f.bytes, "kernel %s, mode %d",
					    kernels_all[k]->name, mode);
		}
		others++;
		compositor_destroy(other);
		free(out);
		random_frame_end(&f);
	}
	assert_true(others > 0);
}

/* ---- a background that is made ---- */

struct maker {
	const struct random_frame *frame;
	_Atomic int *made; /* [height][width]: how often each pixel was made */
};

static void make_part(const void *context, int x, int y, int width, int height, uint8_t *out,
		      size_t out_stride)
{
	const struct maker *m = context;

	assert_int_equal(x % BASIS_TILE, 0);
	for (int v = y; v < y + height; v++) {
		for (int u = x; u < x + width; u++) {
			uint8_t *to = out + (size_t)(v - y) * out_stride + (size_t)(u - x) * 4;

			memcpy(to,
			       m->frame->background + (size_t)v * m->frame->stride + (size_t)u * 4,
			       3);
			to[3] = 255;
			m->made[v * 40 + u]++;
		}
	}
}

TEST("a made background gives the same and is made once")
{
	static _Atomic int made[23 * 40];
	struct synthetic *s = *state;
	struct chance chance = {5};
	struct pool *pool;
	struct random_frame f;
	uint8_t *out;

	assert_int_equal(pool_create(&pool, 3), 0);
	random_frame_begin(&f, &s->basis, pool, &chance);
	out = malloc(f.bytes);
	assert_non_null(out);
	memset(out, 0x5a, f.bytes);
	for (int k = 0; k < 8; k++) {
		const struct maker maker = {&f, made};
		const struct backdrop backdrop = {
			.width = 40, .height = 23, .make = make_part, .context = &maker};
		const struct compositor_settings settings = {
			.mode = (enum compositor_mode)(k & 1),
			.output = {.named = k & 2 ? TRANSFER_LINEAR : TRANSFER_SRGB},
			.gain = 1,
			.object = k & 4};

		memset((void *)made, 0, sizeof(made));
		compositor_set(f.compositor, &settings);
		random_frame_run(&f, 0);
		assert_int_equal(
			compositor_run(f.compositor, 0, &f.lights, &backdrop, out, f.stride), 0);
		expect_same_picture(out, f.out, f.stride, f.bytes, "settings %d", k);
		for (int i = 0; i < 23 * 40; i++)
			expect_equal(made[i], 1, "pixel (%d, %d), settings %d", i % 40, i / 40, k);
	}
	free(out);
	random_frame_end(&f);
	pool_destroy(pool);
}

TEST("wrong sizes are refused")
{
	struct compositor_settings settings = {.gain = 1, .object = true};
	struct chance chance = {5};
	struct synthetic *s = *state;
	struct basis shown;
	struct picture wrong;
	struct backdrop wrong_backdrop;
	struct fault fault = {.text = ""};
	struct compositor *none;
	struct random_frame f;
	double exact;

	random_frame_begin(&f, &s->basis, NULL, &chance);
	wrong = f.picture;
	wrong.width--;
	wrong_backdrop = backdrop_of(&wrong);
	assert_int_equal(
		compositor_run(f.compositor, 0, &f.lights, &wrong_backdrop, f.out, f.stride),
		-EINVAL);
	assert_int_equal(compositor_reference(&s->basis, 0, &settings, &f.lights, &wrong, &exact),
			 -EINVAL);
	assert_int_equal(compositor_run(f.compositor, 1, &f.lights, &f.backdrop, f.out, f.stride),
			 -EINVAL);
	assert_int_equal(compositor_run(f.compositor, -1, &f.lights, &f.backdrop, f.out, f.stride),
			 -EINVAL);
	assert_int_equal(compositor_run(f.compositor, 0, &f.lights, &f.backdrop, f.out, 159),
			 -EINVAL);
	f.lights.count--;
	assert_int_equal(compositor_run(f.compositor, 0, &f.lights, &f.backdrop, f.out, f.stride),
			 -EINVAL);
	f.lights.count++;
	compositor_destroy(f.compositor);
	assert_int_equal(basis_open(&shown, s->path, BASIS_SHOWN, NULL), 0);
	assert_int_equal(compositor_create(&f.compositor, &shown,
					   &(struct compositor_options){.kernel = "auto"}, NULL),
			 0);
	settings.mode = COMPOSITOR_EXACT;
	compositor_set(f.compositor, &settings);
	assert_int_equal(compositor_run(f.compositor, 0, &f.lights, &f.backdrop, f.out, f.stride),
			 -ENODATA);
	assert_int_equal(compositor_reference(&shown, 0, &settings, &f.lights, &f.picture, &exact),
			 -ENODATA);
	assert_int_equal(f.out[0], 0x5a);
	random_frame_end(&f);
	basis_close(&shown);
	assert_int_equal(compositor_create(&none, &s->basis,
					   &(struct compositor_options){.kernel = "abacus"},
					   &fault),
			 -ENOTSUP);
	assert_null(none);
	assert_string_equal(fault.text, "this processor has no kernel called \"abacus\"");
	assert_true(compositor_has_kernel("c") && !compositor_has_kernel("abacus"));
	compositor_destroy(NULL);
}

/* A block may have a column for every light and every group, and a frame may use all of them. */
TEST("every column may be used")
{
	for (int bits = 8; bits <= 16; bits += 8) {
		struct synthetic_options o = plain;
		struct chance chance = {6};
		struct synthetic s;
		struct random_frame f;

		o.vary = o.exact = false;
		o.stand_in_share = 0;
		o.bits = bits;
		o.groups = o.coarse;
		o.columns = o.lights + o.groups;
		o.column_cut = 1e-12;
		synthetic_open(&s, &o);
		random_frame_begin(&f, &s.basis, NULL, &chance);
		random_frame_run(&f, 0);
		/* A group of one light sends nothing besides that light. */
		expect_above(compositor_last(f.compositor).columns,
			     s.basis.poses[0].shown.block_count * o.lights, "bits=%d", bits);
		random_frame_end(&f);
		synthetic_close(&s);
	}
}

static int setup(void **state)
{
	struct synthetic *s = calloc(1, sizeof(*s));

	assert_non_null(s);
	synthetic_open(s, &plain);
	*state = s;
	return 0;
}

static int teardown(void **state)
{
	synthetic_close(*state);
	free(*state);
	return 0;
}

TEST_GROUP(setup, teardown);
