/* SPDX-License-Identifier: MIT */
/* Patterns in residuals. */
#include <math.h>
#include <string.h>

#include "bake/calibrate/camera/camera.h"
#include "hal/optics/tsai.h"
#include "tests/support/calibrate/known_camera.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

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

static double figure_of(const struct camera_solution *solution, const char *key)
{
	for (int k = 0; k < solution->finding.figures; k++)
		if (!strcmp(solution->finding.figure[k].key, key))
			return solution->finding.figure[k].value;
	return 0;
}

/* Noise alone makes no pattern. */
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
