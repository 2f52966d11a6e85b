/* SPDX-License-Identifier: MIT */
/* A camera's response curve, found from simulated exposures. */
#include <math.h>

#include <errno.h>
#include <string.h>

#include "bake/calibrate/response/light_response.h"
#include "tests/support/calibrate/patch_chart.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"

#define EXPOSURES 5
#define DOUBTED_WIDTH 96
#define DOUBTED_HEIGHT 64

static const double times[EXPOSURES] = {1, 0.5, 0.25, 0.125, 0.0625};

struct series {
	struct image picture[EXPOSURES];
	struct light_samples samples;
	struct light_response found;
};

/* Takes pictures of 4 by 3 times side pixels; each patch of 16 by 16 is three samples. */
static void series_take(struct series *s, const struct chart_camera *camera, int side,
			struct chance *chance)
{
	for (int j = 0; j < EXPOSURES; j++) {
		assert_int_equal(image_create_u8(&s->picture[j], 4 * side, 3 * side), 0);
		chart_photograph(camera, 4 * times[j], 2e-3, chance, &s->picture[j]);
	}
}

static void series_find(struct series *s, double black,
			const struct light_response_settings *settings)
{
	const struct image *pictures[EXPOSURES];
	struct fault fault = {""};

	for (int j = 0; j < EXPOSURES; j++)
		pictures[j] = &s->picture[j];
	if (light_samples_create(&s->samples, pictures, EXPOSURES, black, &fault) < 0 ||
	    light_response_find(&s->found, &s->samples, settings, &fault) < 0)
		fail_msg("%s", fault.text);
}

static void series_free(struct series *s)
{
	for (int j = 0; j < EXPOSURES; j++)
		image_free(&s->picture[j]);
	light_samples_free(&s->samples);
	light_response_free(&s->found);
}

static struct light_response_settings exact_times(void)
{
	struct light_response_settings settings = {.time_deviation = 0};

	memcpy(settings.time, times, sizeof(times));
	return settings;
}

static const struct chart_camera cameras[CHART_COUNT] = {
	{CHART_SRGB, 0, 0.001, 0.012},	  {CHART_BT709, 16, 0.001, 0.012},
	{CHART_POWER, 16, 0.001, 0.012},  {CHART_FILM, 8, 0.001, 0.012},
	{CHART_LINEAR, 12, 0.001, 0.012},
};

/* Within 1 % over 80 % of the code values, from 5 exposures with noise and clipping. */
TEST("every shape is found")
{
	const struct light_response_settings settings = exact_times();
	struct chance chance = chance_begin("light");

	for (int k = 0; k < CHART_COUNT; k++) {
		struct series s = {.found = {.samples = 0}};
		double worst = 0, wide = 0;

		series_take(&s, &cameras[k], thorough() ? 80 : 32, &chance);
		series_find(&s, cameras[k].black, &settings);
		for (int code = 1; code < 255; code++) {
			const double u = (code - cameras[k].black) / (255 - cameras[k].black);
			const double truth = chart_curve_decode(cameras[k].curve, u);
			const double off = fabs(
				transfer_curve_decode(&s.found.curve, code / 255.0) / truth - 1);

			if (u >= 0.1 && u <= 0.9)
				worst = fmax(worst, off);
			if (u >= 0.05)
				wide = fmax(wide, off);
		}
		print_message(
			"# %s: %d samples, %d pieces, held out %.2f, sigma %.2f, seen %.3f to %.3f; off by %.2f %% (from 5 %% on %.2f %%); %s\n",
			chart_curve_names[k], s.found.samples, s.found.spline.pieces,
			s.found.held_out, s.found.sigma, s.found.from, s.found.to, 100 * worst,
			100 * wide, s.found.verdict.trusted ? "trusted" : s.found.verdict.reason);
		assert_true(s.found.verdict.trusted);
		expect_below(worst, 0.01, "k=%d", k);
		series_free(&s);
	}
}

/* ---- how sure it is ---- */

/* Knots between 10 % and 90 %, from small pictures: the shares of truths within the deviations. */
TEST("deviations are right")
{
	const struct chart_camera camera = {CHART_SRGB, 0, 0.0005, 0.008};
	const struct light_response_settings settings = exact_times();
	struct chance chance = chance_begin("light");
	const int runs = thorough() ? 40 : 10;
	double worst = 0;
	int within[2] = {0}, all = 0;

	for (int run = 0; run < runs; run++) {
		struct series s = {.found = {.samples = 0}};

		series_take(&s, &camera, thorough() ? 40 : 16, &chance);
		series_find(&s, camera.black, &settings);
		for (int k = 4; k <= 28; k += 4) {
			const double truth = chart_curve_decode(camera.curve, k / 32.0);
			const double off = fabs(s.found.curve.knot[k] - truth);

			within[0] += off <= s.found.deviation[k];
			within[1] += off <= 2 * s.found.deviation[k];
			worst = fmax(worst, off / s.found.deviation[k]);
			all++;
		}
		series_free(&s);
	}
	print_message("# knots: %.3f and %.3f within 1 and 2 deviations, the worst %.1f\n",
		      (double)within[0] / all, (double)within[1] / all, worst);
	/* knots of one run depend on each other: the binomial distribution of the number of runs, 3
	 * deviations */
	assert_true(fabs((double)within[0] / all - 0.683) < 3 * sqrt(0.683 * 0.317 / runs));
	assert_true((double)within[1] / all > 0.954 - 3 * sqrt(0.954 * 0.046 / runs));
}

/* Exposure times that are wrong by up to 3 % are corrected. */
TEST("times are refined")
{
	struct light_response_settings settings = exact_times();
	struct chance chance = chance_begin("light");
	struct series s = {.found = {.samples = 0}};

	series_take(&s, &cameras[CHART_LINEAR], thorough() ? 80 : 32, &chance);
	settings.time[1] *= 1.03;
	settings.time[3] *= 0.98;
	settings.time_deviation = 0.03;
	series_find(&s, cameras[CHART_LINEAR].black, &settings);
	assert_true(s.found.verdict.trusted);
	for (int j = 1; j < EXPOSURES; j++) {
		const double ratio = s.found.time[j] / s.found.time[j - 1] / 0.5;

		print_message("# time %d: ratio off by %.3f %%, deviation %.3f %%\n", j + 1,
			      100 * (ratio - 1), 100 * s.found.time_deviation[j]);
		expect_below(fabs(s.found.time[j] / times[j] / s.found.time[0] - 1),
			     3 * s.found.time_deviation[j] + 1e-3, "j=%d", j);
	}
	series_free(&s);
}

/* ---- hard cases ---- */

static void doubted(const struct series *s, const char *words)
{
	if (s->found.verdict.trusted || !strstr(s->found.verdict.reason, words))
		fail_msg("expected a doubt with \"%s\", got \"%s\"", words,
			 s->found.verdict.trusted ? "trusted" : s->found.verdict.reason);
	assert_true(strlen(s->found.verdict.remedy) > 0);
}

/* All exposures with `factor` times the light, of a chart whose patches go down to `range`. */
static struct series series_of(double factor, double range, struct chance *chance)
{
	struct series s = {.found = {.samples = 0}};

	for (int j = 0; j < EXPOSURES; j++) {
		assert_int_equal(image_create_u8(&s.picture[j], DOUBTED_WIDTH, DOUBTED_HEIGHT), 0);
		chart_photograph(&cameras[CHART_BT709], factor * times[j], range, chance,
				 &s.picture[j]);
	}
	return s;
}

TEST("clipped and dark are doubted")
{
	static const struct {
		double factor, range;
		const char *words;
	} cases[] = {
		{1e5, 0.5, "clipped in all"},
		{1e-5, 0.5, "black in all"},
		{0.2, 0.9, "of the code values were seen"},
		{3e3, 0.5, "only"},
	};
	const struct light_response_settings settings = exact_times();
	struct chance chance = chance_begin("light");

	for (size_t k = 0; k < sizeof(cases) / sizeof(*cases); k++) {
		struct series s = series_of(cases[k].factor, cases[k].range, &chance);

		series_find(&s, 16, &settings);
		if (k < 3)
			doubted(&s, cases[k].words);
		assert_false(s.found.verdict.trusted);
		series_free(&s);
	}
}

TEST("a moved scene is doubted")
{
	const struct light_response_settings settings = exact_times();
	struct chance chance = chance_begin("light");
	struct series s = series_of(4, 2e-3, &chance);

	/* picture 3 is shifted by half a patch */
	memmove(s.picture[2].u8, s.picture[2].u8 + 24, DOUBTED_WIDTH * DOUBTED_HEIGHT * 3 - 24);
	for (int j = 3; j < EXPOSURES; j++)
		memmove(s.picture[j].u8, s.picture[j].u8 + 48,
			DOUBTED_WIDTH * DOUBTED_HEIGHT * 3 - 48);
	series_find(&s, 16, &settings);
	doubted(&s, "do not agree");
	series_free(&s);
}

TEST("a wrong time is named")
{
	struct light_response_settings settings = exact_times();
	struct chance chance = chance_begin("light");
	struct series s = series_of(4, 2e-3, &chance);

	settings.time[2] *= 1.5;
	series_find(&s, 16, &settings);
	doubted(&s, "picture 3 looks as if");
	series_free(&s);
}

/* Shutters run in steps of a third of a stop, which are named by round numbers: 1/60 s is 1/64 s.
 * Such times are refined, and the curve is as right as with the true ones. */
TEST("rounded times are refined")
{
	static const double rounding[EXPOSURES] = {1, 0.95, 1.055, 1.06, 0.97};
	const struct chart_camera *camera = &cameras[CHART_SRGB];
	struct light_response_settings settings = exact_times();
	struct chance chance = chance_begin("light");
	struct series s = {.found = {.samples = 0}};
	double worst = 0;

	for (int j = 0; j < EXPOSURES; j++)
		settings.time[j] *= rounding[j];
	series_take(&s, camera, thorough() ? 160 : 32, &chance);
	series_find(&s, camera->black, &settings);
	for (int k = 4; k <= 28; k++)
		worst = fmax(worst, fabs(s.found.curve.knot[k] / s.found.curve.knot[16] /
						 chart_curve_decode(camera->curve, k / 32.0) *
						 chart_curve_decode(camera->curve, 0.5) -
					 1));
	print_message("# rounded times: off by %.2f %%, said %.2f %%; %.1f times noise; %s\n",
		      100 * worst, 100 * s.found.misfit, s.found.sigma,
		      s.found.verdict.trusted ? "trusted" : s.found.verdict.reason);
	assert_true(s.found.verdict.trusted && s.found.refined);
	expect_at_most(worst, 0.05, "%s", "curve");
	series_free(&s);
	/* who knows may ask for less or accept more */
	settings.misfit = 1e-4;
	s = (struct series){.found = {.samples = 0}};
	series_take(&s, camera, 32, &chance);
	series_find(&s, camera->black, &settings);
	doubted(&s, "linear light is known to");
	series_free(&s);
}

TEST("channels of their own are doubted")
{
	const struct light_response_settings settings = exact_times();
	struct chance chance = chance_begin("light");
	struct series s = series_of(4, 2e-3, &chance);

	/* blue has a curve of its own, the same in every exposure */
	for (int j = 0; j < EXPOSURES; j++)
		for (int k = 2; k < DOUBTED_WIDTH * DOUBTED_HEIGHT * 3; k += 3) {
			const double u = fmax(s.picture[j].u8[k] - 16, 0) / 239.0;

			s.picture[j].u8[k] = (uint8_t)lrint(16 + 239 * pow(u, 0.8));
		}
	series_find(&s, 16, &settings);
	doubted(&s, "channel B has another response");
	print_message("# %s\n", s.found.verdict.reason);
	series_free(&s);
}

TEST("wrong use is refused")
{
	struct light_response_settings settings = exact_times();
	struct chance chance = chance_begin("light");
	struct series s = series_of(4, 2e-3, &chance);
	const struct image *pictures[EXPOSURES];
	struct image small;

	for (int j = 0; j < EXPOSURES; j++)
		pictures[j] = &s.picture[j];
	assert_int_equal(light_samples_create(&s.samples, pictures, 1, 16, NULL), 0);
	assert_int_equal(light_response_find(&s.found, &s.samples, &settings, NULL), 0);
	doubted(&s, "fewer than three");
	light_samples_free(&s.samples);
	assert_int_equal(light_samples_create(&s.samples, pictures, 2, 16, NULL), 0);
	light_response_free(&s.found);
	assert_int_equal(light_response_find(&s.found, &s.samples, &settings, NULL), 0);
	doubted(&s, "fewer than three");
	settings.time[1] = 0;
	light_response_free(&s.found);
	assert_int_equal(light_response_find(&s.found, &s.samples, &settings, NULL), -EINVAL);
	light_samples_free(&s.samples);
	assert_int_equal(light_samples_create(&s.samples, pictures, 2, 255, NULL), -EINVAL);
	assert_int_equal(image_create_u8(&small, 8, 8), 0);
	pictures[1] = &small;
	assert_int_equal(light_samples_create(&s.samples, pictures, 2, 16, NULL), -EINVAL);
	image_free(&small);
	series_free(&s);
}
