/* SPDX-License-Identifier: MIT */
/* Light that clips in the sky is recovered from the light on the ground. */
#include <math.h>
#include <string.h>

#include "hal/lights/recovery.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

enum { LIGHTS = 20 };

/* Lights, some clipped at white = 1, and the true light on the ground. */
struct recovery_sky {
	float radiance[LIGHTS][3], clipped[LIGHTS];
	double lost[3]; /* radiance above white of a clipped pixel in the zenith */
	double u[3][LIGHTS], solid_sr[LIGHTS], piece_sr[LIGHTS];
	struct light_ground ground;
};

/* One piece clips; its light is brighter the higher it is, as light_recover() assumes. */
static void recovery_fill(struct recovery_sky *sky, int clipped, double lost)
{
	double piece_sr = 0;

	*sky = (struct recovery_sky){.lost = {lost, 0.9 * lost, 0.5 * lost}};
	for (int i = 0; i < LIGHTS; i++) {
		sky->clipped[i] = i < clipped ? 0.25f * (float)(i + 1) / (float)clipped : 0;
		sky->solid_sr[i] = 2 * M_PI / LIGHTS * (i % 2 ? 1.2 : 0.8);
		piece_sr += (double)sky->clipped[i] * sky->solid_sr[i];
	}
	for (int i = 0; i < LIGHTS; i++) {
		const double cosine = (i + 1.0) / LIGHTS;

		sky->piece_sr[i] = sky->clipped[i] > 0 ? piece_sr : 0;
		for (int c = 0; c < 3; c++) {
			sky->u[c][i] = 0.5 / M_PI * cosine * sky->solid_sr[i];
			sky->radiance[i][c] = 0.3f + 0.02f * (float)i + 0.01f * (float)c;
			sky->ground.radiance[c] +=
				sky->u[c][i] * ((double)sky->radiance[i][c] +
						(double)sky->clipped[i] * sky->lost[c] * cosine);
		}
	}
}

static struct light_recovery recover(struct recovery_sky *sky, double white)
{
	const struct light_clipping clipping = {
		.lights = LIGHTS,
		.term = {sky->u[0], sky->u[1], sky->u[2]},
		.solid_angle_sr = sky->solid_sr,
		.clipped = sky->clipped,
		.piece_sr = sky->piece_sr,
		.white = white,
	};

	return light_recover(&sky->ground, &clipping, sky->radiance);
}

static double ground_of(const struct recovery_sky *sky, int c)
{
	double sum = 0;

	for (int i = 0; i < LIGHTS; i++)
		sum += sky->u[c][i] * (double)sky->radiance[i][c];
	return sum;
}

TEST("what is lost is found")
{
	static const double lost[] = {3, 10, 1000, 100000};
	struct recovery_sky sky, before;

	for (size_t n = 0; n < sizeof(lost) / sizeof(*lost); n++) {
		struct light_recovery r;

		recovery_fill(&sky, 3, lost[n]);
		before = sky;
		r = recover(&sky, 1);
		expect_that(r.recovered && !r.at_bound, "n=%zu", n);
		for (int c = 0; c < 3; c++) {
			const double share = 1 - ground_of(&before, c) / sky.ground.radiance[c];
			const double unsure = LIGHT_RECOVERY_UNSURE * LIGHT_RECOVERY_UNSURE;
			const double found = share * share / (share * share + unsure);

			expect_below(fabs((r.factor[c] - 1) / (sky.lost[c] * 3 / LIGHTS) - found),
				     1e-4, "n=%zu, c=%d", n, c);
			expect_below(fabs(ground_of(&sky, c) / sky.ground.radiance[c] - 1),
				     share * (1 - found) + 1e-5, "n=%zu, c=%d", n, c);
			for (int i = 0; i < LIGHTS; i++) {
				const double more = (double)sky.radiance[i][c] -
						    (double)before.radiance[i][c];
				const double is = found * (double)sky.clipped[i] * sky.lost[c] *
						  (i + 1) / LIGHTS;

				expect_that(i < 3 ? more > 0 : more == 0, "n=%zu, c=%d, i=%d", n, c,
					    i);
				expect_at_most(fabs(more - is), 1e-4 * is + 1e-6,
					       "n=%zu, c=%d, i=%d", n, c, i);
			}
		}
	}
}

/* Two pieces of very different size give the ground the same light. */
TEST("pieces have like powers")
{
	struct recovery_sky sky, before;
	double small, large;

	recovery_fill(&sky, 0, 0);
	/* Light 9 alone, and lights 10 to 19, all at one height. */
	for (int i = 0; i < LIGHTS; i++) {
		sky.clipped[i] = i < 9 ? 0 : 1;
		sky.piece_sr[i] = i < 9 ? 0 : i == 9 ? 0.3 : 3;
		sky.solid_sr[i] = 0.3;
		for (int c = 0; c < 3; c++) {
			sky.u[c][i] = 0.02;
			sky.radiance[i][c] = i < 9 ? 0.2f : 1;
		}
	}
	before = sky;
	for (int c = 0; c < 3; c++)
		sky.ground.radiance[c] = 10 * ground_of(&sky, c);
	recover(&sky, 1);
	small = (double)sky.radiance[9][0] - 1;
	large = 0;
	for (int i = 10; i < LIGHTS; i++) {
		expect_equal(sky.radiance[i][0], sky.radiance[10][0], "i=%d", i);
		large += (double)sky.radiance[i][0] - 1;
	}
	assert_true(fabs(small / large - 1) < 0.01);
	/* A piece of a few pixels, clipped by noise, gets nothing. */
	sky = before;
	sky.clipped[9] = 1e-4f;
	sky.piece_sr[9] = 3e-5;
	for (int c = 0; c < 3; c++)
		sky.ground.radiance[c] = 10 * ground_of(&sky, c);
	recover(&sky, 1);
	small = (double)sky.radiance[9][0] - 1;
	assert_true(small > 0 && small < 0.04 * large);
}

/* A clipped pixel near the horizon gets less, on the horizon nothing. */
TEST("what lies low gets less")
{
	struct recovery_sky sky;

	recovery_fill(&sky, 0, 0);
	for (int i = 0; i < 3; i++) {
		sky.clipped[i] = 1;
		sky.piece_sr[i] = sky.solid_sr[i] = 0.3;
		for (int c = 0; c < 3; c++) {
			sky.u[c][i] = i * 0.02;
			sky.radiance[i][c] = 1;
		}
	}
	for (int c = 0; c < 3; c++)
		sky.ground.radiance[c] = 10 * ground_of(&sky, c);
	recover(&sky, 1);
	assert_true(sky.radiance[0][1] == 1);
	assert_true(fabs((double)(sky.radiance[2][1] - 1) / (double)(sky.radiance[1][1] - 1) - 2) <
		    1e-5);
	/* Only the light on the horizon clips. The ground does not see it, so its missing light
	 * stays missing. */
	sky.clipped[1] = sky.clipped[2] = 0;
	for (int c = 0; c < 3; c++)
		sky.ground.radiance[c] = 10 * ground_of(&sky, c);
	assert_false(recover(&sky, 1).recovered);
	assert_true(sky.radiance[0][1] == 1);
}

/* A blue sky clips in blue only; the missing red goes to the lamp. */
TEST("colours clip by themselves")
{
	struct recovery_sky sky;

	recovery_fill(&sky, 0, 0);
	for (int i = 18; i < LIGHTS; i++) {
		sky.clipped[i] = 1;
		sky.piece_sr[i] = sky.solid_sr[i] = 0.3;
		for (int c = 0; c < 3; c++) {
			sky.u[c][i] = 0.02;
			sky.radiance[i][c] = i == 18 && c == 0 ? 0.4f : 1;
		}
	}
	for (int c = 0; c < 3; c++)
		sky.ground.radiance[c] = 10 * ground_of(&sky, c);
	recover(&sky, 1);
	assert_true(sky.radiance[18][0] - 0.4f < 0.001f * (sky.radiance[19][0] - 1));
	assert_true(fabs((double)(sky.radiance[18][2] / sky.radiance[19][2]) - 1) < 1e-5);
}

TEST("all may be clipped")
{
	struct light_recovery r;
	struct recovery_sky sky;

	recovery_fill(&sky, 0, 0);
	for (int i = 0; i < LIGHTS; i++) {
		sky.clipped[i] = 1;
		sky.piece_sr[i] = 2 * M_PI;
		for (int c = 0; c < 3; c++)
			sky.radiance[i][c] = 1;
	}
	for (int c = 0; c < 3; c++)
		sky.ground.radiance[c] = 10 * ground_of(&sky, c);
	r = recover(&sky, 1);
	assert_true(r.recovered && !r.at_bound);
	for (int c = 0; c < 3; c++)
		expect_below(fabs(ground_of(&sky, c) / sky.ground.radiance[c] - 1), 1e-3, "c=%d",
			     c);
}

/* A patch or lights that are NaN change nothing. */
TEST("no number adds nothing")
{
	struct recovery_sky sky, before;

	recovery_fill(&sky, 3, 10);
	for (int c = 0; c < 3; c++)
		sky.ground.radiance[c] = c == 0 ? (double)NAN : c == 1 ? -1 : 0;
	before = sky;
	assert_false(recover(&sky, 1).recovered);
	assert_memory_equal(sky.radiance, before.radiance, sizeof(sky.radiance));
	recovery_fill(&sky, 3, 10);
	sky.radiance[5][0] = NAN;
	before = sky;
	assert_true(recover(&sky, 1).factor[0] == 1);
	for (int i = 0; i < LIGHTS; i++)
		assert_memory_equal(&sky.radiance[i][0], &before.radiance[i][0], sizeof(float));
	recovery_fill(&sky, 3, 10);
	sky.clipped[2] = NAN;
	before = sky;
	assert_true(recover(&sky, 1).recovered);
	assert_true(sky.radiance[2][0] == before.radiance[2][0]);
	assert_true(isfinite(sky.radiance[1][0]));
}

/* One light, one equation: it gets exactly the missing light. */
TEST("one light is exact")
{
	struct recovery_sky sky;

	for (int which = 0; which < LIGHTS; which++) {
		recovery_fill(&sky, 0, 0);
		sky.clipped[which] = 0.3f;
		sky.piece_sr[which] = 0.3 * sky.solid_sr[which];
		for (int c = 0; c < 3; c++)
			sky.ground.radiance[c] = ground_of(&sky, c) + 100 * sky.u[c][which];
		recover(&sky, 1);
		for (int c = 0; c < 3; c++)
			expect_below(fabs((double)sky.radiance[which][c] / 100 - 1), 0.01,
				     "which=%d, c=%d", which, c);
	}
}

TEST("where nothing clips nothing is done")
{
	struct light_recovery r;
	struct recovery_sky sky, before;

	recovery_fill(&sky, 0, 0);
	for (int c = 0; c < 3; c++)
		sky.ground.radiance[c] *= 5;
	before = sky;
	r = recover(&sky, 1);
	assert_false(r.recovered || r.at_bound);
	assert_memory_equal(sky.radiance, before.radiance, sizeof(sky.radiance));
}

/* If nothing is missing, or less than nothing, no light is taken away. */
TEST("light is not taken away")
{
	struct light_recovery r;
	struct recovery_sky sky, before;

	recovery_fill(&sky, 3, 0);
	for (int c = 0; c < 3; c++)
		sky.ground.radiance[c] *= 0.7;
	before = sky;
	r = recover(&sky, 1);
	assert_false(r.recovered || r.at_bound);
	assert_true(r.factor[0] == 1 && r.factor[1] == 1 && r.factor[2] == 1);
	assert_memory_equal(sky.radiance, before.radiance, sizeof(sky.radiance));
}

/* A calibration that is wrong by a per cent makes no lamp of a clipped pixel, and the correction
 * has no step. */
TEST("small differences stay small")
{
	double last = 0;

	for (int n = 0; n <= 300; n++) {
		const double off = n / 1000.0;
		double more;
		struct recovery_sky sky;

		recovery_fill(&sky, 1, 0);
		for (int c = 0; c < 3; c++)
			sky.ground.radiance[c] = ground_of(&sky, c) * (1 + off);
		recover(&sky, 1);
		more = ground_of(&sky, 0) * (1 + off) / sky.ground.radiance[0] - 1;
		expect_that(more >= last - 1e-9 && more - last < 0.0025, "n=%d", n);
		expect_at_most(more, off + 1e-6, "n=%d", n);
		if (off <= 0.01)
			expect_below(more, 0.21 * off + 1e-6, "n=%d", n);
		if (off >= 0.2)
			expect_above(more, 0.98 * off, "n=%d", n);
		last = more;
	}
}

TEST("bounds are said")
{
	struct light_recovery r;
	struct recovery_sky sky;

	recovery_fill(&sky, 2, 100);
	for (int c = 0; c < 3; c++)
		sky.ground.radiance[c] *= 1e7;
	r = recover(&sky, 0.5);
	assert_true(r.recovered && r.at_bound);
	for (int c = 0; c < 3; c++)
		expect_below(fabs(r.factor[c] / LIGHT_RECOVERY_MAX - 1), 1e-9, "c=%d", c);
	recovery_fill(&sky, 2, 100);
	sky.ground.clipped = 0.1; /* the patch itself clips, so it shows less than there is */
	r = recover(&sky, 1);
	assert_true(r.recovered && r.at_bound);
}

TEST("a patch is its mean")
{
	enum { WIDTH = 24, HEIGHT = 10 };
	static uint8_t pixels[HEIGHT][WIDTH][4];
	const struct view view = {.width = WIDTH, .height = HEIGHT, .squash = 1};
	const struct picture picture = view_picture(&view, &pixels[0][0][0], sizeof(pixels[0]));
	const struct frame_reader reader = frame_reader_of(&picture);
	struct light_ground ground;
	uint32_t row[WIDTH];
	float decode[256];

	for (int code = 0; code < 256; code++)
		decode[code] = (float)code / 255;
	memset(pixels, 77, sizeof(pixels));
	for (int y = 2; y < 6; y++)
		for (int x = 3; x < 11; x++) {
			pixels[y][x][0] = 51;
			pixels[y][x][1] = (uint8_t)(x % 2 ? 102 : 0);
			pixels[y][x][2] = 255;
		}
	ground = light_ground_see(&reader, 3, 2, 8, 4, decode, row);
	assert_true(fabs(ground.radiance[0] - 1) < 1e-6);
	assert_true(fabs(ground.radiance[1] - 0.2) < 1e-6);
	assert_true(fabs(ground.radiance[2] - 0.2) < 1e-6);
	assert_true(ground.clipped == 1);
	ground = light_ground_see(&reader, 3, 6, 8, 4, decode, row);
	assert_true(ground.clipped == 0 && fabs(ground.radiance[0] - 77 / 255.0) < 1e-6);
}
