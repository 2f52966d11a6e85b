/* SPDX-License-Identifier: MIT */
/*
 * The integer compositor against double precision, over everything that could drive them apart.
 *
 * hal/compositor/README.md derives that they differ by less than 1 level of 8 bits; here it is
 * measured, at the extremes. "max" is the largest distance of an 8-bit result from the exact value,
 * of which the final rounding alone makes up to 0.5.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/compositor/compositor.h"
#include "tests/support/basis/synthetic_basis.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"

#define LEVELS_MOST 1.0
/* The bound where light thrown on the ground is a hundred times the light that is there. Terms a
 * hundred times as large as the result cancel, for which hal/compositor/README.md promises nothing.
 * Of 12 synthetic files two differed by 1.1 and 1.7 levels and one by 2.5. */
#define LEVELS_BEYOND 5.0
/* Distance of a level from a rounding border within which either code is right. */
#define BORDER 0.03

struct accuracy_difference {
	double max, square_sum;
	size_t count;
	int x, y, channel; /* where max occurs */
};

struct accuracy_bench {
	struct synthetic file;
	const char *kernel;
	struct light_selection lights;
	float (*radiance)[3];
	uint8_t *background, *out;
	double *exact;
	int width, height;
	struct compositor_settings settings;
	double threshold;
	enum threshold_mode mode;
	double most; /* largest difference that measure() accepts, in levels */
	struct accuracy_difference all;
};

static void bench_open(struct accuracy_bench *b, const struct synthetic_options *options,
		       struct chance *chance)
{
	const size_t pixels = (size_t)options->width * (size_t)options->height;

	memset(b, 0, sizeof(*b));
	b->most = LEVELS_MOST;
	synthetic_open(&b->file, options);
	assert_int_equal(light_selection_create(&b->lights, &b->file.basis), 0);
	b->width = options->width;
	b->height = options->height;
	b->radiance = calloc((size_t)options->lights, sizeof(*b->radiance));
	b->background = malloc(pixels * 4);
	b->out = malloc(pixels * 4);
	b->exact = malloc(pixels * 3 * sizeof(*b->exact));
	assert_true(b->radiance && b->background && b->out && b->exact);
	for (size_t i = 0; i < pixels * 4;
	     i++) /* mostly dark codes, where a level is a small step of light */
		b->background[i] = (uint8_t)chance_int(chance, 0, i % 3 ? 255 : 12);
	b->settings = (struct compositor_settings){.background = {.named = TRANSFER_SRGB},
						   .output = {.named = TRANSFER_SRGB},
						   .gain = 1,
						   .object = true};
	b->mode = THRESHOLD_DROP;
}

static void bench_close(struct accuracy_bench *b)
{
	light_selection_free(&b->lights);
	free(b->radiance);
	free(b->background);
	free(b->out);
	free(b->exact);
	synthetic_close(&b->file);
}

static void compare(const struct accuracy_bench *b, struct accuracy_difference *d)
{
	for (int i = 0; i < b->width * b->height * 3; i++) {
		const double off = fabs(b->out[i / 3 * 4 + 2 - i % 3] - b->exact[i]);

		d->square_sum += off * off;
		d->count++;
		if (!(off <= d->max)) { /* true for NaN, too */
			d->max = off;
			d->x = i / 3 % b->width;
			d->y = i / 3 / b->width;
			d->channel = i % 3;
		}
	}
}

/* `integer` is what compositor_run() reads; the reference always reads the file itself. */
static struct accuracy_difference measure_with(struct accuracy_bench *b,
					       const struct basis *integer)
{
	const struct picture picture = {b->background, 4, b->width * 4, b->width, b->height};
	const struct backdrop backdrop = backdrop_of(&picture);
	const struct compositor_options options = {.kernel = b->kernel};
	struct accuracy_difference d = {.max = 0};
	struct compositor *compositor;

	light_selection_choose(&b->lights, &b->file.basis, 0, (const float(*)[3])b->radiance,
			       b->threshold, b->mode, b->settings.gain);
	assert_int_equal(compositor_create(&compositor, integer, &options, NULL), 0);
	compositor_set(compositor, &b->settings);
	assert_int_equal(
		compositor_run(compositor, 0, &b->lights, &backdrop, b->out, (size_t)b->width * 4),
		0);
	compositor_destroy(compositor);
	assert_int_equal(compositor_reference(&b->file.basis, 0, &b->settings, &b->lights, &picture,
					      b->exact),
			 0);
	compare(b, &d);
	return d;
}

static void accuracy_measure(struct accuracy_bench *b, const char *name)
{
	const struct accuracy_difference d = measure_with(b, &b->file.basis);

	if (!(d.max <= b->most))
		fail_msg("%s: %.3f levels at pixel %d, %d, channel %d (integer %d, exact %.3f)",
			 name, d.max, d.x, d.y, d.channel,
			 b->out[(d.y * b->width + d.x) * 4 + 2 - d.channel],
			 b->exact[(d.y * b->width + d.x) * 3 + d.channel]);
	b->all.max = fmax(b->all.max, d.max);
	b->all.square_sum += d.square_sum;
	b->all.count += d.count;
}

static void report(const struct accuracy_bench *b, const char *name)
{
	printf("# %-40s max %.4f, RMS %.4f levels\n", name, b->all.max,
	       sqrt(b->all.square_sum / (double)b->all.count));
}

/* ---- lights ---- */

enum light_pattern {
	LIGHTS_DARK,
	LIGHTS_RANDOM,
	LIGHTS_ONE,
	LIGHTS_HUGE,
	LIGHTS_LAMP,	   /* one light a million times as bright as the others */
	LIGHTS_FAINT_LAMP, /* the same, the others at the first code of a camera */
	LIGHTS_NEAR_E,	   /* as much light as e, where the ratio turns to 1 */
	LIGHTS_WIDE,	   /* spread over twelve decades */
	/* every cell at the limit of the camera: all alike, and the object white */
	LIGHTS_SATURATED,
	LIGHTS_DENORMAL, /* below the smallest normal float: dark where a processor flushes these */
	LIGHTS_PATTERNS
};

static const char *const pattern_names[] = {"dark",  "random", "one",  "huge",	    "lamp",
					    "faint", "near e", "wide", "saturated", "denormal"};

static void fill_lights(struct accuracy_bench *b, enum light_pattern pattern, struct chance *chance)
{
	const int n = b->lights.count, chosen = chance_int(chance, 0, n - 1);

	for (int i = 0; i < n; i++) {
		for (int c = 0; c < 3; c++) {
			const double r = chance_real(chance, 0, 1);
			const double values[] = {
				0,
				r,
				i == chosen,
				1e30 * (0.5 + r),
				i == chosen ? 1e6 : r,
				i == chosen ? 300 : 3e-4 * r,
				ldexp(r, -20),
				pow(10, 12 * r - 9),
				1,
				1e-40 * r,
			};

			b->radiance[i][c] = (float)values[pattern];
		}
	}
}

/* All patterns with all ways: here a third of them, each pattern and each way among them. */
static void all_patterns(struct accuracy_bench *b, const char *name, struct chance *chance)
{
	char label[80];

	for (int p = 0; p < LIGHTS_PATTERNS; p++) {
		fill_lights(b, (enum light_pattern)p, chance);
		for (int way = 0; way < 12; way++) {
			const bool exact = way / 6;

			if (exact && !b->file.basis.poses[0].exact.tiles)
				continue;
			if (!thorough() && (way + p) % 3)
				continue;
			b->settings.mode = exact ? COMPOSITOR_EXACT : COMPOSITOR_FAST;
			b->mode = (enum threshold_mode)(way % 2);
			b->threshold = way / 2 % 3 == 0 ? 0 : way / 2 % 3 == 1 ? 0.4 : 1e30;
			snprintf(label, sizeof(label), "%s, %s lights, %s %g, %s", name,
				 pattern_names[p], threshold_mode_names[b->mode], b->threshold,
				 compositor_mode_names[b->settings.mode]);
			accuracy_measure(b, label);
		}
	}
}

/* ---- tests ---- */

static const struct synthetic_options usual = {
	.width = 60,
	.height = 44,
	.lights = 406,
	.grounds = 2,
	.coarse = 100,
	.patterns = 6,
	.columns = 40,
	.layers = 2,
	.vary = true,
	.exact = true,
	.object_share = 0.5,
	.ground_share = 0.4,
	.stand_in_share = 0.4,
	.unlit_share = 0.1,
	.peak = 1,
	.bounce = 0.3,
	.seed = 3,
};

TEST("over lights and thresholds")
{
	struct chance chance = chance_begin("lights and thresholds");
	struct accuracy_bench b;

	bench_open(&b, &usual, &chance);
	all_patterns(&b, "406 lights", &chance);
	report(&b, "406 lights, all patterns");
	bench_close(&b);
}

TEST("over numbers of lights")
{
	static const int counts[] = {1, 6, 26, 33, 6500, 20000};
	struct chance chance = chance_begin("numbers of lights");
	struct accuracy_bench b;

	for (size_t k = 0; k < sizeof(counts) / sizeof(counts[0]); k++) {
		struct synthetic_options o = usual;
		char name[40];

		o.lights = counts[k];
		o.coarse = o.lights < 150 ? 0 : 100;
		o.columns = o.lights < 40 ? o.lights : 40;
		if (o.lights > 1000) {
			o.width = 7;
			o.height = 5;
			o.columns = 1000;
		}
		snprintf(name, sizeof(name), "N = %d", o.lights);
		bench_open(&b, &o, &chance);
		all_patterns(&b, name, &chance);
		report(&b, name);
		bench_close(&b);
	}
}

TEST("over transfers and gains")
{
	static const double gains[] = {0, 1e-3, 0.7, 5, COMPOSITOR_GAIN_MAX};
	struct chance chance = chance_begin("transfers and gains");
	struct synthetic_options o = usual;
	struct accuracy_bench b;

	o.lights = 46;
	o.coarse = 20;
	bench_open(&b, &o, &chance);
	for (int from = 0; from < TRANSFER_COUNT; from++) {
		for (int to = 0; to < TRANSFER_COUNT; to++) {
			for (int g = 0; g < 5; g++) {
				char name[80];

				b.settings.background.named = (enum transfer)from;
				b.settings.output.named = (enum transfer)to;
				b.settings.gain = gains[g];
				snprintf(name, sizeof(name), "%s to %s, gain %g",
					 transfer_names[from], transfer_names[to], gains[g]);
				for (int scale = 0; scale < 5; scale++) {
					if (!thorough() && (from + to + g + scale) % 5)
						continue;
					fill_lights(&b, LIGHTS_RANDOM, &chance);
					for (int i = 0; i < o.lights * 3; i++)
						b.radiance[i / 3][i % 3] *= (float)pow(0.05, scale);
					accuracy_measure(&b, name);
				}
			}
		}
	}
	report(&b, "transfer pairs, gains 0 to 64");
	bench_close(&b);
}

/* Ratios up to their limit, with v far below -1. */
TEST("over added light")
{
	static const double bounces[] = {1, 5, 15, 16, 100};
	struct chance chance = chance_begin("added light");

	for (int k = 0; k < 5; k++) {
		struct synthetic_options o = usual;
		struct accuracy_bench b;
		char name[40];

		o.lights = 86;
		o.coarse = 30;
		o.bounce = bounces[k];
		snprintf(name, sizeof(name), "v down to -%g", o.bounce);
		bench_open(&b, &o, &chance);
		b.most = o.bounce > 16 ? LEVELS_BEYOND : LEVELS_MOST;
		all_patterns(&b, name, &chance);
		report(&b, name);
		bench_close(&b);
	}
}

TEST("over sizes")
{
	struct chance chance = chance_begin("sizes");
	struct accuracy_difference all = {.max = 0};

	for (int width = 1; width <= 65; width++) {
		struct synthetic_options o = usual;
		struct accuracy_bench b;

		o.lights = o.columns = 6;
		o.coarse = 0;
		o.width = width;
		o.height = width == 1 ? 1 : chance_int(&chance, 1, 35);
		o.seed = (uint64_t)width;
		bench_open(&b, &o, &chance);
		fill_lights(&b, LIGHTS_RANDOM, &chance);
		accuracy_measure(&b, "odd size");
		all.max = fmax(all.max, b.all.max);
		bench_close(&b);
	}
	printf("# widths 1 to 65: max %.4f levels\n", all.max);
}

/* Objects and shadows in single pixels, on both sides of the borders of tiles and in tiles that the
 * edge of the picture cuts. Lists have length one, so that kernels work mostly on padding. */
TEST("single pixels")
{
	struct chance chance = chance_begin("single pixels");
	struct accuracy_difference all = {.max = 0};

	for (int k = 0; k < 12; k++) {
		struct synthetic_options o = usual;
		struct accuracy_bench b;

		o.lights = 46;
		o.coarse = 20;
		o.columns = 46;
		o.width = 33 + k % 3;
		o.height = 17 + k % 2;
		o.object_share = o.ground_share = o.stand_in_share = 1.0 / BASIS_TILE / BASIS_TILE;
		o.seed = (uint64_t)k + 1;
		bench_open(&b, &o, &chance);
		all_patterns(&b, "single pixels", &chance);
		all.max = fmax(all.max, b.all.max);
		bench_close(&b);
	}
	printf("# single pixels: max %.4f levels\n", all.max);
	assert_true(all.max > 0.3); /* the test saw differences at all */
}

/* While all light goes out in small steps, neither result may jump. */
TEST("darkness comes without a jump")
{
	struct chance chance = chance_begin("darkness");
	struct synthetic_options o = usual;
	double *before, jump = 0;
	struct accuracy_bench b;
	uint8_t *bytes_before;
	int byte_jump = 0;
	size_t values;

	o.lights = 46;
	o.coarse = 20;
	o.object_share = 0; /* only the ratio is left */
	bench_open(&b, &o, &chance);
	values = (size_t)b.width * (size_t)b.height * 3;
	before = malloc(values * sizeof(*before));
	bytes_before = malloc(values);
	assert_true(before && bytes_before);
	for (int step = 0; step <= 400; step++) {
		const double light = step == 400 ? 0 : pow(10, -2 - step / 40.0);

		for (int i = 0; i < o.lights * 3; i++)
			b.radiance[i / 3][i % 3] = (float)(light * (1 + i % 7));
		accuracy_measure(&b, "darkness");
		for (size_t i = 0; i < values; i++) {
			const uint8_t byte = b.out[i / 3 * 4 + 2 - i % 3];

			if (step) {
				jump = fmax(jump, fabs(b.exact[i] - before[i]));
				byte_jump = abs(byte - bytes_before[i]) > byte_jump
						    ? abs(byte - bytes_before[i])
						    : byte_jump;
			}
			before[i] = b.exact[i];
			bytes_before[i] = byte;
		}
	}
	for (size_t i = 0; i < values; i++) /* in the end, the background itself */
		expect_equal(bytes_before[i], b.background[i / 3 * 4 + 2 - i % 3], "i=%zu", i);
	printf("# light falling by 6 %% a step: largest change %.2f levels, integer %d\n", jump,
	       byte_jump);
	assert_true(jump < 5 && byte_jump <= jump + 1);
	free(before);
	free(bytes_before);
	bench_close(&b);
}

/* The same picture in light a million times dimmer. Only ratios count, so nothing may change except
 * by e, and the integers must follow the exact values there as well. */
TEST("dimness loses no precision")
{
	struct chance chance = chance_begin("dimness");
	struct synthetic_options o = usual;
	struct accuracy_bench b;

	o.object_share = 0;
	o.stand_in_share = 0.5;
	bench_open(&b, &o, &chance);
	for (int mode = 0; mode < COMPOSITOR_MODE_COUNT; mode++) {
		b.settings.mode = (enum compositor_mode)mode;
		for (int power = -44; power <= 30; power += thorough() ? 2 : 6) {
			fill_lights(&b, LIGHTS_RANDOM, &chance);
			for (int i = 0; i < o.lights * 3; i++)
				b.radiance[i / 3][i % 3] *= (float)pow(10, power);
			accuracy_measure(&b, "dim light");
		}
	}
	report(&b, "light of 1e-44 to 1e30, ratios");
	bench_close(&b);
}

/* v near 1 everywhere: the result is a small difference of large sums. A bright background makes
 * its errors visible. */
TEST("deficits may nearly cancel")
{
	struct chance chance = chance_begin("cancellation");
	struct synthetic_options o = usual;
	struct accuracy_bench b;

	o.bounce = -0.995; /* v in 0.995..1 */
	o.object_share = 0;
	bench_open(&b, &o, &chance);
	memset(b.background, 255, (size_t)b.width * (size_t)b.height * 4);
	all_patterns(&b, "v near 1", &chance);
	report(&b, "v near 1");
	bench_close(&b);
}

/* Makes all coefficients of all patterns equal, in all channels. */
static void make_constant(const struct basis_block *b, int16_t *lines)
{
	const int panels = basis_panels16(b->pixels);

	for (int c = 0; c < b->channels; c++)
		for (int p = 0; p < b->pixels; p++)
			for (int j = 0; j < b->patterns; j++)
				lines[basis_line16(panels, b->patterns, c, p / BASIS_LINE16, j) *
					      BASIS_LINE16 +
				      (size_t)(p % BASIS_LINE16)] = 32767;
}

/* Patterns that are copies of each other, lines that are equal for all pixels, scales of 0 and
 * below the smallest normal float: each of these is a valid file. */
TEST("duplicate and constant lines")
{
	struct chance chance = chance_begin("degenerate lines");
	struct synthetic_options o = usual;
	struct fault fault;
	struct basis odd;
	struct accuracy_bench b;
	uint8_t *copy;

	bench_open(&b, &o, &chance);
	copy = aligned_alloc(BASIS_PAGE, (b.file.basis.map_bytes / BASIS_PAGE + 1) * BASIS_PAGE);
	assert_non_null(copy);
	memcpy(copy, b.file.basis.map, b.file.basis.map_bytes);
	assert_int_equal(
		basis_open_memory(&odd, copy, b.file.basis.map_bytes, "copy", BASIS_ALL, &fault),
		0);
	for (int n = 0; n < odd.poses[0].shown.block_count; n++) {
		const struct basis_block *k = &odd.poses[0].shown.blocks[n];
		int16_t *pattern = (int16_t *)(copy + ((const uint8_t *)k->pattern - copy));
		int16_t *lines = (int16_t *)(copy + ((const uint8_t *)k->coefficient - copy));
		float *scale = (float *)(copy + ((const uint8_t *)k->column_scale - copy));

		for (int j = 1; j < k->patterns && n % 3 == 0; j++)
			memcpy(pattern + j * k->stride, pattern,
			       sizeof(*pattern) * (size_t)k->stride);
		if (n % 3 == 1)
			make_constant(k, lines);
		for (int i = 0; i < k->columns && n % 3 == 2; i++)
			scale[i] = i % 2 ? 0 : 1e-40F;
	}
	for (int p = 0; p < LIGHTS_PATTERNS; p++) {
		const struct basis whole = b.file.basis;
		struct accuracy_difference d;

		fill_lights(&b, (enum light_pattern)p, &chance);
		b.file.basis = odd;
		d = measure_with(&b, &odd);
		b.file.basis = whole;
		b.all.max = fmax(b.all.max, d.max);
		expect_at_most(d.max, LEVELS_MOST, "p=%d", p);
	}
	printf("# degenerate lines: max %.4f levels\n", b.all.max);
	basis_close(&odd);
	free(copy);
	bench_close(&b);
}

/* Leaving out dim columns may change a pixel by no more than the block's share of the cut, for each
 * block that holds a column of the light. Tried one light at a time. Returns the largest change. */
static double leave_out(double cut, double share, struct chance *chance)
{
	struct synthetic_options o = usual;
	struct accuracy_bench b;
	double most = 0;

	o.lights = 200;
	o.columns = 120;
	o.column_cut = cut;
	o.cut_share = share;
	o.stand_in_share = 0;
	o.layers = 1;
	bench_open(&b, &o, chance);
	b.settings.output.named = TRANSFER_LINEAR;
	for (int k = 0; k < 60; k++) {
		struct accuracy_difference d;

		fill_lights(&b, k % 2 ? LIGHTS_ONE : LIGHTS_RANDOM, chance);
		if (k % 2) {
			for (int i = 0; i < o.lights * 3; i++)
				b.radiance[i / 3][i % 3] *= (float)pow(10,
								       -chance_real(chance, 0, 3));
		} else {
			for (int i = 0; i < o.lights * 3; i++)
				b.radiance[i / 3][i % 3] *= 0.2F;
		}
		d = measure_with(&b, &b.file.basis);
		/* Every column of T and V may be left out, all with errors of the same sign. */
		expect_at_most(d.max, LEVELS_MOST + 255 * share * cut * (k % 2 ? 2 : 2 * o.columns),
			       "k=%d, share %g", k, share);
		if (k % 2)
			most = fmax(most, d.max);
	}
	bench_close(&b);
	printf("# one light, columns below %g of %g left out: max %.3f levels, linear\n", share,
	       cut, most);
	return most;
}

TEST("left out columns change no more than declared")
{
	struct chance chance = chance_begin("left out");

	assert_true(leave_out(0.004, 1, &chance) > 0.55); /* else no column was left out */
	leave_out(0.064, 1.0 / 16, &chance);
}

/* Largest change of any code when the lights change. */
static int change(struct accuracy_bench *b, uint8_t *before)
{
	const size_t bytes = (size_t)b->width * (size_t)b->height * 4;
	int most = 0;

	memcpy(before, b->out, bytes);
	measure_with(b, &b->file.basis);
	for (size_t i = 0; i < bytes; i++)
		most = abs(b->out[i] - before[i]) > most ? abs(b->out[i] - before[i]) : most;
	return most;
}

/* Camera noise: one cell of the sky flickers by one level. */
TEST("a flicker does not crawl")
{
	struct chance chance = chance_begin("flicker");
	struct synthetic_options o = usual;
	uint8_t *before;
	struct accuracy_bench b;

	o.column_cut = 0.002;
	bench_open(&b, &o, &chance);
	before = malloc((size_t)b.width * (size_t)b.height * 4);
	assert_non_null(before);
	fill_lights(&b, LIGHTS_RANDOM, &chance);
	measure_with(&b, &b.file.basis);
	for (int k = 0; k < (thorough() ? 60 : 20); k++) {
		const int light = chance_int(&chance, 0, o.lights - 1);
		const int level = chance_int(&chance, 0, 254);

		for (int c = 0; c < 3; c++)
			b.radiance[light][c] = (float)transfer_decode(TRANSFER_SRGB, level / 255.0);
		measure_with(&b, &b.file.basis);
		for (int c = 0; c < 3; c++)
			b.radiance[light][c] = (float)transfer_decode(TRANSFER_SRGB,
								      (level + 1) / 255.0);
		expect_at_most(change(&b, before), 1, "k=%d", k);
	}
	free(before);
	bench_close(&b);
}

/* Light fades by half a per cent a frame. The object must darken by one level at a time and never
 * brighten, and shadows must stay. */
/* Exact level, in double precision, of the byte out[i] of a BGRX picture. */
static double exact_of(const struct accuracy_bench *b, size_t i)
{
	return i % 4 == 3 ? 0 : b->exact[i / 4 * 3 + 2 - i % 4];
}

/* A level that does not change, as the ground's, may lie on a border of two codes. */
TEST("slow fades show no steps")
{
	struct chance chance = {77};
	struct synthetic_options o = usual;
	uint8_t *before;
	struct accuracy_bench b;
	size_t bytes;

	o.stand_in_share = 0;
	o.bounce = 0.1;
	o.exact = false;
	bench_open(&b, &o, &chance);
	bytes = (size_t)b.width * (size_t)b.height * 4;
	before = malloc(bytes);
	assert_non_null(before);
	fill_lights(&b, LIGHTS_RANDOM, &chance);
	measure_with(&b, &b.file.basis);
	for (int k = 0; k < (thorough() ? 300 : 100); k++) {
		for (int i = 0; i < o.lights * 3; i++)
			b.radiance[i / 3][i % 3] *= 0.995F;
		expect_at_most(change(&b, before), 1, "k=%d", k);
		for (size_t i = 0; i < bytes; i++)
			expect_that(b.out[i] <= before[i] ||
					    fabs(exact_of(&b, i) - before[i] - 0.5) < BORDER,
				    "k=%d, i=%zu", k, i);
	}
	free(before);
	bench_close(&b);
}

/* One light at its threshold, a level above and below in turn. Without a band of hysteresis the
 * whole cell would come and go with each frame, and the object would flicker (light_selection has
 * the band). The bound is the change of the level itself. */
TEST("the threshold crosses its own light")
{
	enum { GREY = 200, FRAMES = 40 };
	const double at = transfer_decode(TRANSFER_SRGB, GREY / 255.0);
	const double below = transfer_decode(TRANSFER_SRGB, (GREY - 1) / 255.0);
	struct chance chance = chance_begin("threshold");
	struct synthetic_options o = usual;
	int most[2] = {0};
	uint8_t *before;
	struct accuracy_bench b;

	o.lights = 26;
	o.coarse = 12;
	o.columns = 11;
	bench_open(&b, &o, &chance);
	before = malloc((size_t)b.width * (size_t)b.height * 4);
	assert_non_null(before);
	fill_lights(&b, LIGHTS_RANDOM, &chance);
	b.threshold = at;
	for (int n = 0; n < 2 * THRESHOLD_MODE_COUNT * FRAMES; n++) {
		const int banded = n / FRAMES % 2, k = n % FRAMES;
		int off;

		b.mode = (enum threshold_mode)(n / FRAMES / 2);
		b.lights.band = banded ? (at - below) * 1.001 : 0;
		for (int c = 0; c < 3; c++)
			b.radiance[9][c] = (float)(k % 2 ? below : at * 1.0001);
		off = change(&b, before);
		most[banded] = k > 0 && off > most[banded] ? off : most[banded];
		expect_equal(b.lights.used[9], k % 2 == 0 || banded, "n=%d", n);
		accuracy_measure(&b, "threshold");
	}
	printf("# a light that crosses its threshold by a level: change %d with a band, %d without\n",
	       most[1], most[0]);
	assert_true(most[1] <= 1 && most[0] > 3);
	free(before);
	bench_close(&b);
}

/* Partial coverage where a wrong share of the background shows most, and a dark background under so
 * much light that the object saturates. */
TEST("edges over black and white")
{
	struct chance chance = chance_begin("edges");
	struct accuracy_bench b;

	bench_open(&b, &usual, &chance);
	for (int white = 0; white < 2; white++) {
		memset(b.background, white ? 255 : 0, (size_t)b.width * (size_t)b.height * 4);
		all_patterns(&b, white ? "over white" : "over black", &chance);
	}
	report(&b, "over black and over white");
	bench_close(&b);
}

/* A compositor that is wrong by a little must fail. Here it reads a file in which the first block
 * of a kind is 5 % too strong. */
TEST("a wrong compositor is noticed")
{
	struct chance chance = chance_begin("wrong compositor");
	struct synthetic_options o = usual;
	struct basis wrong;
	struct fault fault;
	struct accuracy_bench b;
	uint8_t *copy;

	o.vary = false;
	bench_open(&b, &o, &chance);
	fill_lights(&b, LIGHTS_RANDOM, &chance);
	for (int i = 0; i < b.lights.count * 3; i++)
		b.radiance[i / 3][i % 3] *= 0.5F; /* dark enough that nothing clips */
	copy = aligned_alloc(BASIS_PAGE, (b.file.basis.map_bytes / BASIS_PAGE + 1) * BASIS_PAGE);
	assert_non_null(copy);
	memcpy(copy, b.file.basis.map, b.file.basis.map_bytes);
	assert_int_equal(basis_open_memory(&wrong, copy, b.file.basis.map_bytes, "copy",
					   BASIS_SHOWN, &fault),
			 0);
	assert_true(measure_with(&b, &wrong).max <= LEVELS_MOST);
	for (int kind = 0; kind < BASIS_KIND_COUNT; kind++) {
		const struct basis_block *block = wrong.poses[0].shown.blocks;
		float *scale;

		while (block->kind != (enum basis_kind)kind)
			block++;
		scale = (float *)(copy + ((const uint8_t *)block->pattern_scale - copy));
		for (int j = 0; j < block->patterns; j++)
			scale[j] *= 1.05F;
		expect_above(measure_with(&b, &wrong).max, LEVELS_MOST, "kind=%d", kind);
		memcpy(copy, b.file.basis.map, b.file.basis.map_bytes);
	}
	basis_close(&wrong);
	free(copy);
	bench_close(&b);
}
