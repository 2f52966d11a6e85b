/* SPDX-License-Identifier: MIT */
/* What makes a simulated camera's picture a camera's, against closed forms. */
#include <math.h>
#include <stdlib.h>

#include "drivers/sim/sim.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

static void fill(float *rgb, size_t count, const double colour[3])
{
	for (size_t i = 0; i < 3 * count; i++)
		rgb[i] = (float)colour[i % 3];
}

/* A scene that changes at frame 0: s(n) = wanted + (s(-1) - wanted) exp(-n period / time). */
TEST("automatics settle with their time constant")
{
	static const double before[3] = {0.2, 0.1, 0.05}, after[3] = {0.4, 0.4, 0.1};
	static const double level = 0.18, exposure = 2, period = 0.04, time = 0.5;
	struct automatic a = {.settings = {level, true, time, 0}};
	float rgb[8 * 3], gain[3];

	fill(rgb, 8, before);
	for (int n = 0; n < 3; n++) {
		automatic_gain(&a, rgb, 8, exposure, period, gain);
		for (int c = 0; c < 3; c++)
			assert_true(fabs((double)gain[c] -
					 level / (2 * 0.35 / 3) * 0.1 / before[c]) < 1e-5);
	}
	fill(rgb, 8, after);
	for (int n = 0; n < 100; n++) {
		const double left = n ? exp(-n * period / time) : 1;

		automatic_gain(&a, rgb, 8, exposure, period, gain);
		for (int c = 0; c < 3; c++) {
			const double from = log2(level / (2 * 0.35 / 3)) + log2(0.1 / before[c]);
			const double to = log2(level / (2 * 0.9 / 3)) + log2(0.4 / after[c]);

			expect_that(fabs(log2((double)gain[c]) - (to + (from - to) * left)) < 1e-5,
				    "frame %d channel %d", n, c);
		}
	}
}

TEST("automatics move in steps")
{
	static const double before[3] = {0.1, 0.1, 0.1}, after[3] = {0.4, 0.4, 0.4};
	struct automatic a = {.settings = {0.1, false, 1, 0.25}};
	float rgb[3], gain[3];

	fill(rgb, 1, before);
	automatic_gain(&a, rgb, 1, 1, 0.1, gain);
	assert_true(gain[0] == 1 && gain[1] == 1 && gain[2] == 1);
	fill(rgb, 1, after);
	for (int n = 0; n < 60; n++) {
		const double s = -2 * -expm1(-0.1 * n);

		automatic_gain(&a, rgb, 1, 1, 0.1, gain);
		assert_true(fabs(log2((double)gain[1]) - 0.25 * rint(s / 0.25)) < 1e-6);
	}
	/* Black has no goal. */
	fill(rgb, 1, (double[3]){0, 0, 0});
	automatic_gain(&a, rgb, 1, 1, 0.1, gain);
	assert_true(gain[1] == 0.25f);
}

/* The slope of a blurred edge between two pixels has the Gaussian's second moment. */
TEST("an edge spreads as a gaussian")
{
	static const double sigmas[] = {0.5, 0.8, 1.5, 4};
	enum { WIDTH = 80, HEIGHT = 3, EDGE = 40 };
	static float rgb[3 * WIDTH * HEIGHT], scratch[3 * WIDTH * HEIGHT], to[3 * WIDTH * HEIGHT];

	for (int i = 0; i < 3 * WIDTH * HEIGHT; i++)
		rgb[i] = i / 3 % WIDTH < EDGE ? 1 : 3;
	for (size_t k = 0; k < sizeof(sigmas) / sizeof(*sigmas); k++) {
		double sum = 0, moment = 0, want = sigmas[k] * sigmas[k];

		spread_edges(rgb, WIDTH, HEIGHT, sigmas[k], scratch, to);
		for (int x = 1; x < WIDTH; x++) {
			const double slope = (double)to[3 * (WIDTH + x)] -
					     (double)to[3 * (WIDTH + x - 1)];

			sum += slope;
			moment += slope * (x - EDGE) * (x - EDGE);
		}
		expect_that(fabs(sum - 2) < 1e-5, "sigma %g: sum %g", sigmas[k], sum);
		expect_that(fabs(moment / sum / want - 1) < 2e-3, "sigma %g: moment %g", sigmas[k],
			    moment / sum);
		/* Rows are equal, so the vertical pass changes nothing. */
		for (int i = 0; i < 3 * WIDTH; i++)
			assert_true(to[i] == to[i + 3 * WIDTH]);
	}
}

/* Rows against the lamp's light, summed in small steps over the time that a row is exposed. */
TEST("rows see the lamp while they are exposed")
{
	const struct mains mains = {.depth = 0.4, .hz = 60, .shutter_s = 0.003, .readout_s = 0.025};

	for (int y = 0; y < 48; y += 5) {
		const double begin = 3.21 + mains.readout_s * y / 48;
		double sum = 0;

		for (int i = 0; i < 1000; i++)
			sum += 1 + 0.4 * cos(2 * M_PI * 120 *
					     (begin + mains.shutter_s * (i + 0.5) / 1000));
		assert_true(fabs(mains_row(&mains, 3.21, y, 48) - sum / 1000) < 1e-6);
	}
}

/* A view's row is linear in the panels: flicker of 1 + d in a row makes it on + d (on - off). */
TEST("panels flicker in rows")
{
	enum { SIDE = 24 };
	static float on[SIDE][SIDE][3], off[SIDE][SIDE][3], flickering[SIDE][SIDE][3];
	static const double from[3] = {0, -1.7, 0.95}, at[3] = {0, 0, 0.12};
	struct studio_lamps lamps = studio_lamps(2.5, 0);
	struct sim_eye eye = {.width = SIDE, .height = SIDE};
	struct studio_view *view;
	double swing = 0;

	assert_int_equal(tsai_look_at(&eye.camera, SIDE, SIDE, from, at, 46, NULL), 0);
	assert_int_equal(studio_view_create(&view, &eye), 0);
	studio_view_render(view, &lamps, on[0][0]);
	lamps.panels = 0;
	studio_view_render(view, &lamps, off[0][0]);
	lamps.panels = 1;
	lamps.mains = (struct mains){.depth = 0.5, .hz = 50, .shutter_s = 1e-3, .readout_s = 0.03};
	studio_view_render(view, &lamps, flickering[0][0]);
	for (int y = 0; y < SIDE; y++) {
		const double d = mains_row(&lamps.mains, 2.5, y, SIDE) - 1;

		swing = fmax(swing, fabs(d));
		for (int i = 0; i < 3 * SIDE; i++) {
			const double full = (double)on[y][i / 3][i % 3];
			const double want = full + d * (full - (double)off[y][i / 3][i % 3]);

			expect_that(fabs((double)flickering[y][i / 3][i % 3] - want) < 1e-5,
				    "row %d value %d", y, i);
		}
	}
	assert_true(swing > 0.4);
	studio_view_destroy(view);
}
