/* SPDX-License-Identifier: MIT */
/* Patterns in residuals, and pictures that were turned by 180 degrees. */
#include <math.h>
#include <string.h>

#include "bake/calibrate/camera/camera.h"
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

static void see_boards(struct observations *seen, struct tsai_camera *first, double kappa2,
		       double noise, struct chance *chance)
{
	*seen = (struct observations){.width = KNOWN_CAMERA_WIDTH, .height = KNOWN_CAMERA_HEIGHT};
	for (int v = 0; v < VIEWS; v++) {
		struct tsai_camera c = known_camera_roll(
			known_camera(eyes[v], middle, -0.1, TSAI_DISTORTS), 0.7 * v);

		c.kappa2 = kappa2 / pow(hypot(c.width, c.height) / 2 * c.pixel[0], 4);
		c.centre_px[0] += 9;
		c.centre_px[1] -= 5;
		known_camera_see_large_board(seen, &c, noise, chance);
		if (!v)
			*first = c;
	}
}

static void turn_views(struct observations *seen, unsigned views)
{
	for (int i = 0; i < seen->count; i++)
		if (views >> seen->point[i].view & 1) {
			seen->point[i].px[0] = seen->width - seen->point[i].px[0];
			seen->point[i].px[1] = seen->height - seen->point[i].px[1];
		}
}

static double figure_of(const struct camera_solution *solution, const char *key)
{
	for (int k = 0; k < solution->finding.figures; k++)
		if (!strcmp(solution->finding.figure[k].key, key))
			return solution->finding.figure[k].value;
	return 0;
}

/* Distance of the axis from the truth in declared deviations. */
static double axis_off(const struct camera_solution *solution, double x, double y)
{
	const struct estimate *estimate = &solution->finding.estimate;
	const int cx = estimate_find(estimate, "centre x"),
		  cy = estimate_find(estimate, "centre y");

	return fmax(fabs(estimate->parameter[cx].value - x) / estimate_deviation(estimate, cx),
		    fabs(estimate->parameter[cy].value - y) / estimate_deviation(estimate, cy));
}

/* Whichever pictures are turned, the axis is that of the reference view's picture. */
TEST("turned pictures")
{
	static const unsigned turned[] = {0, 4, 2 | 16, 2 | 4 | 8, 2 | 4 | 8 | 16 | 32, 1, 1 | 8};
	struct chance chance = chance_begin("camera turned");

	for (unsigned k = 0; k < 2 * sizeof(turned) / sizeof(*turned); k += thorough() ? 1 : 3) {
		const unsigned views = turned[k / 2];
		struct tsai_camera truth;
		struct observations seen;
		struct camera_task task;
		struct camera_solution solution;
		double x, y;
		int count = 0;

		see_boards(&seen, &truth, k % 2 ? 0.08 : 0, k % 2 ? 0.1 : 0.3, &chance);
		turn_views(&seen, views);
		for (int v = 1; v < VIEWS; v++)
			count += (views >> v & 1) != (views & 1);
		task = known_camera_task(&truth);
		assert_int_equal(camera_calibrate(&seen, &task, &solution, NULL), 0);
		expect_that(known_camera_trusted(&solution), "k=%u", k);
		expect_equal((int)figure_of(&solution, "views_turned"), count, "k=%u", k);
		x = truth.centre_px[0];
		y = truth.height - truth.centre_px[1];
		expect_below(axis_off(&solution, views & 1 ? truth.width - x : x,
				      views & 1 ? truth.height - y : y),
			     4, "k=%u", k);
		for (int i = 0; i < seen.count; i++)
			expect_below(hypot(solution.finding.expected[i][0] - seen.point[i].px[0],
					   solution.finding.expected[i][1] - seen.point[i].px[1]),
				     2, "k=%u, i=%d", k, i);
		camera_solution_free(&solution);
		observations_free(&seen);
	}
}

/* A board that looks the same upside down is numbered from its other end: another pose, no turned
 * picture. */
TEST("symmetrical boards")
{
	struct chance chance = chance_begin("camera symmetrical");
	struct tsai_camera truth;
	struct observations seen;
	struct camera_task task;
	struct camera_solution solution;

	see_boards(&seen, &truth, 0, 0.2, &chance);
	for (int i = 0; i < seen.count; i++)
		for (int k = 0; k < 2; k++)
			if (seen.point[i].view % 2)
				seen.point[i].world[k] = -seen.point[i].world[k];
	task = known_camera_task(&truth);
	assert_int_equal(camera_calibrate(&seen, &task, &solution, NULL), 0);
	assert_true(known_camera_trusted(&solution));
	assert_true(figure_of(&solution, "views_turned") == 0);
	assert_true(axis_off(&solution, truth.centre_px[0], truth.height - truth.centre_px[1]) < 4);
	camera_solution_free(&solution);
	observations_free(&seen);
}

/* Noise alone makes no pattern and turns no picture, also where the axis is in the middle. */
TEST("noise is no pattern")
{
	struct chance chance = chance_begin("camera pattern");
	double most = 0;

	for (int run = 0; run < 20; run++) {
		struct tsai_camera truth;
		struct observations seen;
		struct camera_task task;
		struct camera_solution solution;

		see_boards(&seen, &truth, 0, 0.1 + 0.1 * (run % 5), &chance);
		task = known_camera_task(&truth);
		assert_int_equal(camera_calibrate(&seen, &task, &solution, NULL), 0);
		expect_that(known_camera_trusted(&solution), "run=%d", run);
		expect_equal((int)figure_of(&solution, "views_turned"), 0, "run=%d", run);
		most = fmax(most, figure_of(&solution, "structure_sigmas"));
		camera_solution_free(&solution);
		observations_free(&seen);
	}
	print_message("patterns of at most %.3g deviations\n", most);
	assert_true(most < 5);
}

/* A window before the lens that shifts a part of every picture: no such lens is known. */
TEST("pattern is said")
{
	struct chance chance = chance_begin("camera window");

	for (int known = 0; known < 2; known++) {
		struct tsai_camera truth;
		struct observations seen;
		struct camera_task task;
		struct camera_solution solution;

		see_boards(&seen, &truth, 0, 0.2, &chance);
		for (int i = 0; i < seen.count; i++)
			if (seen.point[i].px[0] > 400 && seen.point[i].px[1] > 300)
				seen.point[i].px[0] += 0.8;
		task = known ? camera_task_default() : known_camera_task(&truth);
		task.intrinsics = known ? &truth : NULL;
		assert_int_equal(camera_calibrate(&seen, &task, &solution, NULL), 0);
		expect_that(!solution.finding.verdict.trusted, "known=%d", known);
		expect_that(strstr(solution.finding.verdict.reason, "where noise explains"),
			    "known=%d: %s", known, solution.finding.verdict.reason);
		camera_solution_free(&solution);
		observations_free(&seen);
	}
}
