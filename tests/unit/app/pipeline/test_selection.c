/* SPDX-License-Identifier: MIT */
/* The lights that a frame uses, from frame to frame. A light at the threshold must not come and go
 * with the noise of a camera, a light that falls must go, and a picture without a frame before it
 * is chosen by the threshold alone. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/pipeline/pipeline.h"
#include "tests/support/basis/hand_block.h"
#include "tests/support/basis/random_frame.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

enum { COUNT = 1500, FRAMES = 1000 };

static const struct synthetic_options options = {
	.width = 20,
	.height = 17,
	.lights = COUNT,
	.coarse = 20,
	.patterns = 4,
	.columns = 30,
	.layers = 1,
	.grounds = 1,
	.column_cut = 0.001,
	.object_share = 0.5,
	.ground_share = 0.4,
	.peak = 1,
	.bounce = 0.3,
	.seed = 8,
};

static float level(double grey)
{
	return (float)transfer_decode(TRANSFER_SRGB, grey / 255);
}

/* ---- the choice ---- */

struct choice {
	struct synthetic file;
	struct random_frame f;
	float radiance[COUNT][3];
	double threshold;
	enum threshold_mode mode;
};

/* A sky of grey level 120, a threshold at grey level 40, and a band of one grey level. */
static void choice_begin(struct choice *c, double band)
{
	struct chance chance = {5}; /* always the same background */

	*c = (struct choice){.threshold = (double)level(40), .mode = THRESHOLD_DROP};
	synthetic_open(&c->file, &options);
	random_frame_begin(&c->f, &c->file.basis, NULL, &chance);
	c->f.lights.band = band;
	for (int i = 0; i < COUNT; i++)
		for (int k = 0; k < 3; k++)
			c->radiance[i][k] = level(120);
}

static void choice_end(struct choice *c)
{
	random_frame_end(&c->f);
	synthetic_close(&c->file);
}

static void test_selection_choose(struct choice *c)
{
	light_selection_choose(&c->f.lights, &c->file.basis, 0, (const float(*)[3])c->radiance,
			       c->threshold, c->mode, 1);
}

static void test_selection_set(struct choice *c, int light, double grey)
{
	for (int k = 0; k < 3; k++)
		c->radiance[light][k] = level(grey);
}

static bool uses(struct choice *c, int light, double grey)
{
	test_selection_set(c, light, grey);
	test_selection_choose(c);
	return c->f.lights.used[light];
}

static double one_level(void)
{
	/* Tolerance: radiance is in single precision. */
	return (double)(level(40) - level(39)) + 1e-6;
}

struct crossing {
	int switches; /* lights that became used or unused */
	int changes;  /* frames whose picture changed */
	int largest;  /* largest change of a code value */
};

/* Some lights flicker between grey 39 and 40. */
static struct crossing flicker(struct choice *c, int lights)
{
	uint8_t *before = malloc(c->f.bytes);
	struct crossing found = {0};
	bool used = false;

	assert_non_null(before);
	for (int k = 0; k < FRAMES; k++) {
		bool changed = false;

		for (int i = 0; i < lights; i++)
			test_selection_set(c, 7 + i, 39 + k % 2);
		test_selection_choose(c);
		random_frame_run(&c->f, 0);
		found.switches += c->f.lights.used[7] != used;
		used = c->f.lights.used[7];
		for (size_t b = 0; k > 1 && b < c->f.bytes; b++) {
			const int off = abs(c->f.out[b] - before[b]);

			changed |= off > 0;
			found.largest = off > found.largest ? off : found.largest;
		}
		found.changes += changed;
		memcpy(before, c->f.out, c->f.bytes);
	}
	free(before);
	return found;
}

TEST("a light at the threshold does not flicker")
{
	struct choice c;

	for (int mode = 0; mode < THRESHOLD_MODE_COUNT; mode++) {
		struct crossing found;

		choice_begin(&c, one_level());
		c.mode = (enum threshold_mode)mode;
		found = flicker(&c, 1);
		expect_equal(found.switches, 1, "mode=%d", mode);
		expect_equal(found.changes, 0, "mode=%d", mode);
		choice_end(&c);

		/* Most of the sky: the picture changes by no more than one level of light. */
		choice_begin(&c, one_level());
		c.mode = (enum threshold_mode)mode;
		found = flicker(&c, COUNT - 10);
		expect_equal(found.switches, 1, "mode=%d", mode);
		expect_at_most(found.largest, 2, "mode=%d", mode);
		choice_end(&c);

		choice_begin(&c, 0); /* without a band, this test sees the flicker */
		c.mode = (enum threshold_mode)mode;
		found = flicker(&c, COUNT - 10);
		expect_equal(found.switches, FRAMES - 1, "mode=%d", mode);
		expect_that(mode != THRESHOLD_DROP ? found.changes > FRAMES / 2
						   : found.largest > 10,
			    "mode=%d", mode);
		choice_end(&c);
	}
}

TEST("a light that falls goes out")
{
	struct choice c;

	choice_begin(&c, one_level());
	assert_false(uses(&c, 7, 39.5)); /* not used before, so the threshold decides */
	assert_true(uses(&c, 7, 40));
	assert_true(uses(&c, 7, 39));
	assert_false(uses(&c, 7, 38.9));
	assert_false(uses(&c, 7, 39.9)); /* used again at the threshold, not before */
	assert_true(uses(&c, 7, 40.1));
	assert_true(uses(&c, 7, 39.5));
	for (double grey = 39.5; grey > 38; grey -= 0.01) /* a slow fade switches off once */
		expect_equal(uses(&c, 7, grey), grey > 38.995, "grey=%g", grey);
	assert_false(uses(&c, 7, 0));
	test_selection_set(&c, 7, 0);
	c.radiance[7][1] = level(40); /* in any channel */
	test_selection_choose(&c);
	assert_true(c.f.lights.used[7]);
	c.radiance[7][1] = NAN;
	test_selection_choose(&c);
	assert_false(c.f.lights.used[7]);
	choice_end(&c);
}

/* Another threshold or mode starts anew; threshold 0 uses all lights. */
TEST("another threshold begins anew")
{
	struct choice c;

	choice_begin(&c, one_level());
	assert_true(uses(&c, 7, 40));
	assert_true(uses(&c, 7, 39.5));
	c.mode = THRESHOLD_AMBIENT;
	assert_false(uses(&c, 7, 39.5));
	assert_true(uses(&c, 7, 40));
	c.threshold = (double)level(40.2);
	assert_false(uses(&c, 7, 40.1));
	c.threshold = (double)level(39.9);
	assert_true(uses(&c, 7, 40));
	c.threshold = 0;
	assert_true(uses(&c, 7, 0));
	c.threshold = (double)level(40);
	assert_false(uses(&c, 7, 39.9));
	choice_end(&c);
}

/* A picture before any light was measured does not influence later choices. */
TEST("darkness is no state")
{
	bool fresh[COUNT];
	struct choice c;

	for (int dark = 0; dark < 2; dark++) {
		choice_begin(&c, 0);
		c.f.lights.budget = 0.5;
		c.threshold = 0;
		if (dark) {
			memset(c.radiance, 0, sizeof(c.radiance));
			test_selection_choose(&c);
		}
		for (int i = 0; i < COUNT; i++)
			test_selection_set(&c, i, 20 + i);
		test_selection_choose(&c);
		assert_in_range(c.f.lights.used_count, 1, COUNT - 1);
		if (dark)
			assert_memory_equal(fresh, c.f.lights.used, sizeof(fresh));
		memcpy(fresh, c.f.lights.used, sizeof(fresh));
		choice_end(&c);
	}
}

/* What the selection reports of dropped light agrees with the lights that were dropped. */
TEST("what is said is of what was chosen")
{
	struct choice c;

	choice_begin(&c, one_level());
	c.mode = THRESHOLD_AMBIENT;
	assert_true(uses(&c, 7, 40));
	for (int k = 0; k < 2; k++) { /* inside the band, then below it */
		const double grey = k ? 38.5 : 39.5, w = c.file.basis.lights[7].solid_angle_sr;
		const double l = k ? (double)level(grey) : 0;

		expect_equal(uses(&c, 7, grey), !k, "k=%d", k);
		expect_equal(c.f.lights.used_count, COUNT - k, "k=%d", k);
		expect_equal(c.f.lights.radiance[7][0], (k ? 0 : (double)level(grey)), "k=%d", k);
		expect_below(fabs(c.f.lights.ambient[0] - w * l / (2 * M_PI)), 1e-12, "k=%d", k);
		for (int n = 0; n < 3; n++) {
			const float(*peak)[3] = c.file.basis.poses[0].peak;
			const double lost = fmax(l * (double)peak[7][n],
						 c.f.lights.ambient[n] * (double)peak[COUNT][n]);

			expect_at_most(fabs(c.f.lights.dropped_error[n] - lost), 1e-12,
				       "k=%d, n=%d", k, n);
		}
	}
	choice_end(&c);
}

/* ---- the band of a fisheye ---- */

enum { SIDE = 32, LIGHTS = 6 };

static void write_dome(const char *path)
{
	struct basis_info_chunk info = {.width = 1,
					.height = 1,
					.lights = LIGHTS,
					.dome_frequency = 1,
					.poses = 1,
					.coarse = LIGHTS};
	static const float value[3 * LIGHTS] = {1}, peak[LIGHTS + 1][3] = {{1}, [LIGHTS] = {1}};
	static const uint16_t coverage = 65535, pixel = 0;
	struct basis_light lights[LIGHTS];
	struct basis_block_payload block;

	hand_block_lights(1, LIGHTS, lights);
	block = hand_block_of_object(0, 1, &pixel, LIGHTS, lights, value);
	hand_block_file(path, &info, lights, &block, &coverage, peak);
}

/* Number of lights used under an even sky of this code. */
static int used_under(struct pipeline *p, int code, double threshold)
{
	static uint8_t pixels[SIDE * SIDE * 4];
	const struct picture picture = {pixels, 4, SIDE * 4, SIDE, SIDE};
	const struct pipeline_choice choice = {.threshold = {.value = threshold}, .object = true};
	struct fault fault = {""};

	memset(pixels, code, sizeof(pixels));
	synthetic_must(pipeline_light_picture(p, &picture, &fault), &fault);
	synthetic_must(pipeline_choose(p, &choice, &fault), &fault);
	return pipeline_report(p).lights_used;
}

static void check_levels(struct pipeline *p, int black)
{
	for (int t = black + 4; t < 255; t += t < 40 ? 1 : 9) {
		/* The first picture: the threshold alone. */
		assert_int_equal(used_under(p, t - 1, t), 0);
		expect_equal(used_under(p, t + 1, t), LIGHTS, "t=%d", t);
		for (int k = 0; k < 4; k++)
			expect_equal(used_under(p, t - k % 2, t), LIGHTS, "t=%d, k=%d", t, k);
		expect_equal(used_under(p, t - 1, t), LIGHTS, "t=%d", t);
		assert_int_equal(used_under(p, t - 2, t), 0);
		assert_int_equal(used_under(p, t - 1, t), 0);
	}
}

/* Whatever the curve, black level and gain of the camera, the band is one level of its picture. */
TEST("the band is a level of the picture")
{
	static const double gains[] = {0.02, 1, 9};
	char folder[] = "/tmp/inlay-selection-XXXXXX", path[64];
	struct fault fault = {""};
	struct basis basis;

	assert_non_null(mkdtemp(folder));
	snprintf(path, sizeof(path), "%s/dome.inlay", folder);
	write_dome(path);
	synthetic_must(basis_open(&basis, path, BASIS_SHOWN, &fault), &fault);
	for (int n = 0; n < TRANSFER_COUNT * 2 * 3; n++) {
		const int black = n / TRANSFER_COUNT % 2 ? 16 : 0;
		const struct pipeline_settings settings = {
			.sampler = {.curve = {.named = (enum transfer)(n % TRANSFER_COUNT),
					      .black = black},
				    .gain = gains[n / TRANSFER_COUNT / 2]},
			.lens = {.field_deg = 90},
			.gain = 1,
			.threads = 1,
		};
		struct pipeline *pipeline;

		synthetic_must(pipeline_create(&pipeline, &basis, &settings, &fault), &fault);
		check_levels(pipeline, black);
		pipeline_destroy(pipeline);
	}
	basis_close(&basis);
	unlink(path);
	rmdir(folder);
}
