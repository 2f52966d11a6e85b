/* SPDX-License-Identifier: MIT */
/* Lenses of one and more radial terms: how many are found, and what is said of too few. */
#include <math.h>
#include <string.h>

#include "bake/calibrate/camera/camera.h"
#include "bake/calibrate/camera/camera_model.h"
#include "hal/optics/tsai.h"
#include "tests/support/calibrate/known_camera.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"

#define VIEWS 6

static const double eyes[VIEWS][3] = {{0.16, -0.38, 0.42}, {-0.36, -0.2, 0.45}, {0.38, 0.05, 0.45},
				      {0.05, 0.4, 0.4},	   {-0.15, 0.34, 0.5},	{-0.1, -0.4, 0.35}};
static const double middle[3] = {0.01, 0.005, 0};

/* Bends of a lens, relative to the radius of the picture's corner: at r = 1 it is their sum. */
struct bends {
	double k[3];
};

/* Barrel distortion that turns back near the corners ("mustache"). */
static const struct bends mustache = {{-0.12, 0.1, 0}}, barrel = {{-0.08, 0, 0}};

static struct tsai_camera lens_at(int view, const struct bends *bends, int distortion)
{
	struct tsai_camera c = known_camera_roll(
		known_camera(eyes[view], middle, bends->k[0], distortion), 0.7 * view);
	const double half = hypot(c.width, c.height) / 2 * c.pixel[0];

	c.kappa2 = bends->k[1] / pow(half, 4);
	c.kappa3 = bends->k[2] / pow(half, 6);
	c.centre_px[0] += 9;
	c.centre_px[1] -= 5;
	assert_int_equal(tsai_check(&c, NULL), 0);
	return c;
}

static void see_boards(struct observations *seen, struct tsai_camera truth[VIEWS],
		       const struct bends *bends, int distortion, double noise,
		       struct chance *chance)
{
	*seen = (struct observations){.width = KNOWN_CAMERA_WIDTH, .height = KNOWN_CAMERA_HEIGHT};
	for (int v = 0; v < VIEWS; v++) {
		truth[v] = lens_at(v, bends, distortion);
		known_camera_see_large_board(seen, &truth[v], noise, chance);
	}
}

static struct camera_solution calibrate(const struct observations *seen,
					const struct tsai_camera *truth, int radial)
{
	struct camera_task task = known_camera_task(truth);
	struct camera_solution solution;

	task.radial = radial;
	assert_int_equal(camera_calibrate(seen, &task, &solution, NULL), 0);
	assert_true(solution.solved);
	return solution;
}

static bool finds(const struct camera_solution *solution, const char *name)
{
	const struct estimate *estimate = &solution->finding.estimate;

	return !estimate->parameter[estimate_find(estimate, name)].fixed;
}

/* Distance from the truth in declared deviations. */
static double off_by(const struct camera_solution *solution, const char *name, double truth)
{
	const struct estimate *estimate = &solution->finding.estimate;
	const int k = estimate_find(estimate, name);

	return fabs(estimate->parameter[k].value - truth) / estimate_deviation(estimate, k);
}

/* Largest error of the picture over a grid, px, of what the true camera sees at its points. */
static double picture_error(const struct tsai_camera *found, const struct tsai_camera *truth)
{
	double worst = 0;

	for (int n = 0; n < 81; n++) {
		const double px[2] = {truth->width * (n % 9) / 8.0, truth->height * (n / 9) / 8.0};
		double origin[3], dir[3], back[2], point[3];

		assert_int_equal(tsai_ray(truth, px, origin, dir), 0);
		for (int k = 0; k < 3; k++)
			point[k] = origin[k] + 0.6 * dir[k];
		assert_int_equal(tsai_project(found, point, back), 0);
		worst = fmax(worst, hypot(back[0] - px[0], back[1] - px[1]));
	}
	return worst;
}

TEST("one term is enough")
{
	struct chance chance = chance_begin("radial one");

	for (int run = 0; run < (thorough() ? 12 : 4); run++) {
		struct observations seen;
		struct tsai_camera truth[VIEWS];
		struct camera_solution solution;

		see_boards(&seen, truth, &barrel, run & 1, run % 3 ? 0.3 : 0.05, &chance);
		solution = calibrate(&seen, &truth[0], run & 2 ? 0 : 1);
		expect_that(known_camera_trusted(&solution), "run=%d", run);
		expect_that(!finds(&solution, "kappa2"), "run=%d", run);
		assert_true(solution.camera.kappa2 == 0 && solution.camera.kappa3 == 0);
		camera_solution_free(&solution);
		observations_free(&seen);
	}
}

TEST("too few terms are said")
{
	struct chance chance = chance_begin("radial few");

	for (int run = 0; run < (thorough() ? 6 : 2); run++) {
		struct observations seen;
		struct tsai_camera truth[VIEWS];
		struct camera_solution solution;

		see_boards(&seen, truth, &mustache, run & 1, run % 3 ? 0.3 : 0.05, &chance);
		solution = calibrate(&seen, &truth[0], 1);
		expect_that(!solution.finding.verdict.trusted, "run=%d", run);
		expect_that(strstr(solution.finding.verdict.reason, "1 radial term"), "run=%d: %s",
			    run, solution.finding.verdict.reason);
		expect_that(strstr(solution.finding.verdict.remedy, "--radial 2"), "run=%d: %s",
			    run, solution.finding.verdict.remedy);
		camera_solution_free(&solution);
		observations_free(&seen);
	}
}

/* Two terms, given or found, are trusted; centre and kappas are as near as they say. */
TEST("two terms")
{
	struct chance chance = chance_begin("radial two");
	double most = 0, squares = 0;
	int count = 0;

	for (int run = 0; run < (thorough() ? 12 : 4); run++) {
		struct observations seen;
		struct tsai_camera truth[VIEWS];
		struct camera_solution solution;
		double off[4];

		see_boards(&seen, truth, &mustache, run & 1, run % 3 ? 0.3 : 0.05, &chance);
		solution = calibrate(&seen, &truth[0], run & 2 ? 0 : 2);
		expect_that(known_camera_trusted(&solution), "run=%d", run);
		expect_that(finds(&solution, "kappa2") && !finds(&solution, "kappa3"), "run=%d",
			    run);
		off[0] = off_by(&solution, "centre x", truth[0].centre_px[0]);
		off[1] = off_by(&solution, "centre y", truth[0].height - truth[0].centre_px[1]);
		off[2] = off_by(&solution, "kappa1", truth[0].kappa1);
		off[3] = off_by(&solution, "kappa2", truth[0].kappa2);
		for (int k = 0; k < 4; k++, count++) {
			most = fmax(most, off[k]);
			squares += off[k] * off[k];
		}
		expect_below(picture_error(&solution.camera, &truth[0]), 1, "run=%d", run);
		camera_solution_free(&solution);
		observations_free(&seen);
	}
	print_message("off by %.3g deviations at most, %.3g rms\n", most, sqrt(squares / count));
	assert_true(most < 4);
	assert_true(!thorough() || sqrt(squares / count) < 1.4); /* too few for it */
}

TEST("three terms")
{
	static const struct bends wave = {{-0.3, 0.5, -0.25}};
	struct chance chance = chance_begin("radial three");
	struct observations seen;
	struct tsai_camera truth[VIEWS];
	struct camera_solution solution;

	see_boards(&seen, truth, &wave, TSAI_DISTORTS, 0.05, &chance);
	solution = calibrate(&seen, &truth[0], 0);
	assert_true(known_camera_trusted(&solution));
	assert_true(finds(&solution, "kappa3"));
	assert_true(off_by(&solution, "kappa3", truth[0].kappa3) < 4);
	assert_true(picture_error(&solution.camera, &truth[0]) < 0.3);
	camera_solution_free(&solution);
	observations_free(&seen);
}

/* A pose alone, with a known lens of all terms. */
TEST("known lens")
{
	struct chance chance = chance_begin("radial known");
	struct tsai_camera truth[VIEWS], lens;
	struct observations seen = {.width = 0};
	struct camera_task task = camera_task_default();
	struct camera_solution solution;

	for (int way = 0; way < 2; way++) {
		truth[0] = lens_at(0, &mustache, way);
		truth[0].tangential[0] = 1e-5;
		truth[0].tangential[1] = -1.7e-5;
		assert_int_equal(tsai_check(&truth[0], NULL), 0);
		known_camera_see_board(&seen, &truth[0], 9, 6, 0, &chance);
		lens = truth[0];
		task.intrinsics = &lens;
		assert_int_equal(camera_calibrate(&seen, &task, &solution, NULL), 0);
		assert_true(known_camera_trusted(&solution));
		for (int k = 0; k < 3; k++)
			expect_below(fabs(solution.camera.translation[k] - truth[0].translation[k]),
				     1e-7, "way=%d, k=%d", way, k);
		expect_below(picture_error(&solution.camera, &truth[0]), 1e-4, "way=%d", way);
		camera_solution_free(&solution);
		observations_free(&seen);
	}
}
