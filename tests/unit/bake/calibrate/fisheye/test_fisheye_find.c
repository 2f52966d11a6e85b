/* SPDX-License-Identifier: MIT */
/* Fisheye lenses from boards: right without noise, with honest uncertainty under
 * noise, and doubted where they should be. */
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/fisheye/fisheye_find.h"
#include "hal/base/clock.h"
#include "tests/support/calibrate/fisheye_views.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"

static struct fisheye_wanted wanted_of(int model)
{
	return (struct fisheye_wanted){
		.model = model, .field_deg = 88, .tolerance_px = 0.5, .world_view = -1};
}

static struct fisheye lens_of(const struct fisheye_settings *settings)
{
	struct fisheye lens;

	assert_int_equal(fisheye_prepare(&lens, settings, 640, 480, NULL), 0);
	return lens;
}

static void see(struct observations *seen, const struct fisheye_settings *truth, int boards,
		double sigma, struct chance *chance)
{
	const struct fisheye lens = lens_of(truth);

	fisheye_views_begin(seen);
	fisheye_see_boards(seen, &lens, boards, 1.15, sigma, chance);
}

enum { NUMBERS = 8 };

/* Parameters of the lens in the order of an estimate. */
static void truths(const struct fisheye_settings *s, double number[NUMBERS])
{
	for (int i = 0; i < 2; i++) {
		number[i] = s->focal_px[i];
		number[2 + i] = s->centre_px[i];
	}
	memcpy(number + 4, s->polynomial, 4 * sizeof(double));
}

TEST("right without noise")
{
	struct chance chance = chance_begin("fisheye_find");

	for (int k = 0; k < 2 * FISHEYE_MODEL_COUNT; k++) {
		const int model = k / 2;
		const struct fisheye_wanted wanted = wanted_of(k & 1 ? FISHEYE_MODEL_AUTO : model);
		struct fisheye_result result;
		struct observations seen;
		struct fault fault = {""};
		double truth[NUMBERS];
		char said[600];

		see(&seen, &fisheye_views_lenses[model], 5, 0, &chance);
		assert_int_equal(fisheye_find(&result, &seen, &wanted, &fault), 0);
		verdict_sentence(&result.finding.verdict, said, sizeof(said));
		print_message("# %s: %s, rms %.2g\n", fisheye_model_names[model], said,
			      result.finding.rms_px);
		assert_true(result.finding.verdict.trusted);
		expect_equal(result.lens.model, model, "k=%d", k);
		truths(&fisheye_views_lenses[model], truth);
		for (int n = 0; n < NUMBERS; n++)
			expect_below(fabs(result.finding.estimate.parameter[n].value - truth[n]),
				     1e-6 * fmax(fabs(truth[n]), n < 4 ? 1 : 1e-2), "k=%d, n=%d", k,
				     n);
		fisheye_result_free(&result);
		observations_free(&seen);
	}
}

/* How often the truth lies within 1, 2 and 3 deviations. */
struct coverage {
	int runs, within[3];
};

static void test_find_count(struct coverage *c, double deviations)
{
	c->runs++;
	c->within[0] += deviations < 1;
	c->within[1] += deviations < 1.959964;
	c->within[2] += deviations < 3;
}

/* Checks these shares. The numbers of one run depend on each other, so that the bound counts runs.
 */
static void check_coverage(const struct coverage *all, int runs)
{
	static const double want[2] = {0.682689, 0.95};

	for (int k = 0; k < 2; k++)
		expect_below(fabs((double)all->within[k] / all->runs - want[k]),
			     4 * sqrt(want[k] * (1 - want[k]) / runs), "k=%d", k);
	assert_true(all->within[2] >= 0.99 * all->runs);
}

/* Number of runs: INLAY_RUNS, else few, with wider bounds, and a third of them where time
 * matters. */
static int runs_of(int usual)
{
	const char *text = getenv("INLAY_RUNS");

	return text ? (int)strtol(text, NULL, 10) : thorough() ? usual : usual / 3;
}

TEST("honest with noise")
{
	enum { RUNS = 12 };
	const double sigma = 0.3;
	struct chance chance = chance_begin("fisheye_find");
	int64_t start = clock_now_ns();
	struct coverage total = {.runs = 0};
	int runs = 0;

	for (int model = 0; model < FISHEYE_MODEL_COUNT; model++) {
		struct fisheye_wanted wanted = wanted_of(model);
		struct coverage all = {.runs = 0};
		double truth[NUMBERS];
		const int own = runs_of(RUNS);

		truths(&fisheye_views_lenses[model], truth);
		wanted.tolerance_px = 50;
		for (int run = 0; run < own; run++) {
			struct fisheye_result result;
			struct observations seen;
			const struct estimate *e;

			see(&seen, &fisheye_views_lenses[model], 12, sigma, &chance);
			assert_int_equal(fisheye_find(&result, &seen, &wanted, NULL), 0);
			e = &result.finding.estimate;
			expect_above(e->count, 0, "model=%d, run=%d", model, run);
			/* the solver did not end in a wrong minimum */
			expect_below(result.finding.rms_px, 1.25 * M_SQRT2 * sigma,
				     "model=%d, run=%d", model, run);
			for (int n = 0; n < NUMBERS; n++) {
				if (e->parameter[n].fixed)
					continue;
				test_find_count(&all, fabs(e->parameter[n].value - truth[n]) /
							      estimate_deviation(e, n));
			}
			fisheye_result_free(&result);
			observations_free(&seen);
		}
		expect_at_least(all.within[2], (0.99 - 4 * sqrt(0.0099 / own)) * all.runs,
				"model=%d", model);
		total.runs += all.runs;
		for (int i = 0; i < 3; i++)
			total.within[i] += all.within[i];
		runs += own;
		print_message("# %s: %.1f %% within 1, %.1f %% within 1.96, %.2f %% within 3\n",
			      fisheye_model_names[model], 100.0 * all.within[0] / all.runs,
			      100.0 * all.within[1] / all.runs, 100.0 * all.within[2] / all.runs);
	}
	check_coverage(&total, runs);
	print_message("# %d runs: %.1f %%, %.1f %%, %.2f %%\n", runs,
		      100.0 * total.within[0] / total.runs, 100.0 * total.within[1] / total.runs,
		      100.0 * total.within[2] / total.runs);
	print_message("# %.1f s\n", (double)(clock_now_ns() - start) / 1e9);
}

static void test_find_expect(struct observations *seen, const struct fisheye_wanted *wanted,
			     const char *expected)
{
	struct fisheye_result result;
	struct fault fault = {""};
	char said[600];

	assert_int_equal(fisheye_find(&result, seen, wanted, &fault), 0);
	verdict_sentence(&result.finding.verdict, said, sizeof(said));
	print_message("# %s\n", said);
	assert_non_null(strstr(said, expected));
	assert_true(result.finding.verdict.trusted == !strcmp(expected, "trusted"));
	fisheye_result_free(&result);
	observations_free(seen);
}

/* Leaves the points that are seen within so many degrees of the axis. */
static void keep_within(struct observations *seen, const struct fisheye *lens, double most_deg)
{
	struct observations kept;

	fisheye_views_begin(&kept);
	for (int v = 0; v < seen->views; v++) {
		assert_int_equal(observations_begin_view(&kept, seen->view[v].name), 0);
		for (int n = 0; n < seen->view[v].count; n++) {
			const struct observation *point = &seen->point[seen->view[v].first + n];
			double ray[3];

			if (fisheye_ray(lens, point->px, ray) &&
			    acos(ray[0] * lens->rotation[6] + ray[1] * lens->rotation[7] +
				 ray[2] * lens->rotation[8]) < most_deg * M_PI / 180)
				assert_int_equal(observations_add(&kept, point->world, point->px,
								  "%s", point->name),
						 0);
		}
	}
	observations_free(seen);
	*seen = kept;
}

TEST("doubted")
{
	struct chance chance = chance_begin("fisheye_find");
	const struct fisheye_settings *truth = &fisheye_views_lenses[FISHEYE_EQUIDISTANT];
	const struct fisheye lens = lens_of(truth);
	const struct fisheye_wanted wanted = wanted_of(FISHEYE_MODEL_AUTO);
	const struct fisheye_wanted wrong = wanted_of(FISHEYE_STEREOGRAPHIC);
	struct fisheye_result result;
	struct observations seen;
	struct fault fault = {""};

	see(&seen, truth, 9, 0.3, &chance);
	seen.view[0].count = 3;
	test_find_expect(&seen, &wanted, "shows 3 points of the board, fewer than 4");
	fisheye_views_begin(&seen);
	fisheye_see_boards(&seen, &lens, 9, 0.2, 0.02, &chance);
	keep_within(&seen, &lens, 25);
	test_find_expect(&seen, &wanted, "cannot be told apart");
	fisheye_views_begin(&seen);
	fisheye_see_boards(&seen, &lens, 9, 0.5, 0.02, &chance);
	keep_within(&seen, &lens, 55);
	test_find_expect(&seen, &wanted, "nothing was seen beyond");
	see(&seen, truth, 9, 0.3, &chance);
	test_find_expect(&seen, &wrong, "not where a lens of the stereographic model");
	see(&seen, truth, 9, 6, &chance);
	test_find_expect(&seen, &wanted, "the lens is known to");
	fisheye_views_begin(&seen);
	fisheye_see_board(&seen, &lens, 0.5, 1, 0, 0.2, &chance);
	test_find_expect(&seen, &wanted, "one place only");
	see(&seen, truth, 9, 0.2, &chance);
	for (int n = 0; n < seen.count; n++)
		seen.point[n].px[0] = 640 - seen.point[n].px[0];
	test_find_expect(&seen, &wanted, "mirrored");
	see(&seen, truth, 9, 0.2, &chance);
	for (int n = seen.view[seen.views - 1].first, end = seen.count; n < end; n++) {
		/* Adding points may move the array. */
		const struct observation point = seen.point[n];

		assert_int_equal(observations_add(&seen, point.world, point.px, "again %d", n), 0);
	}
	test_find_expect(&seen, &wanted, "are one point listed twice");
	see(&seen, truth, 9, 0.2, &chance);
	for (int n = 0; n < 5; n++)
		seen.point[7 * n].px[1] += 40; /* outliers must not matter */
	test_find_expect(&seen, &wanted, "trusted");
	see(&seen, truth, 9, 0.2, &chance);
	seen.point[3].px[0] = NAN;
	assert_int_equal(fisheye_find(&result, &seen, &wanted, &fault), -EINVAL);
	assert_non_null(strstr(fault.text, "board 1 corner 3,0: is not finite"));
	observations_free(&seen);
}
