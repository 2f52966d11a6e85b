/* SPDX-License-Identifier: MIT */
/* Photographs of a board through a fisheye: found, solved, and right where corners were seen. */
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/fisheye/fisheye_find.h"
#include "bake/calibrate/observe/boards.h"
#include "tests/support/calibrate/fisheye_photographs.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

/* Largest angle from the axis at which a corner was seen, rad. */
static double seen_to(const struct observations *seen, const struct fisheye *lens)
{
	double most = 0;

	for (int n = 0; n < seen->count; n++) {
		double ray[3];

		expect_that(fisheye_ray(lens, seen->point[n].px, ray), "n=%d", n);
		most = fmax(most, acos(ray[2]));
	}
	return most;
}

static double error_of(const struct fisheye *truth, const struct fisheye_settings *found,
		       double most_rad)
{
	struct fisheye lens;
	double worst = 0;

	assert_int_equal(fisheye_prepare(&lens, found, FISHEYE_PHOTOGRAPH_WIDTH,
					 FISHEYE_PHOTOGRAPH_HEIGHT, NULL),
			 0);
	for (int k = 0; k < 2000; k++) {
		const double theta = most_rad * sqrt((k + 0.5) / 2000), phi = k * 2.39996;
		const double ray[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
		double is[2], should[2];

		expect_that(fisheye_project(&lens, ray, is) && fisheye_project(truth, ray, should),
			    "k=%d", k);
		worst = fmax(worst, hypot(is[0] - should[0], is[1] - should[1]));
	}
	return worst;
}

static void photographs(enum fisheye_model model, double focal_px)
{
	const struct fisheye_settings settings = {.focal_px = {focal_px, 0.96 * focal_px},
						  .centre_px = {483.2, 357.4},
						  .field_deg = 88,
						  .model = (int)model};
	const struct fisheye_wanted wanted = {
		.model = (int)model, .field_deg = 88, .tolerance_px = 0.5, .world_view = -1};
	struct chance chance = chance_begin(fisheye_model_names[model]);
	struct observations seen = {.width = 0};
	struct fisheye_result result;
	struct fisheye truth;
	struct board board;
	double most, error;
	int found = 0;
	char said[600];

	assert_int_equal(board_parse(&board, "9x6:20mm", NULL), 0);
	assert_int_equal(fisheye_prepare(&truth, &settings, FISHEYE_PHOTOGRAPH_WIDTH,
					 FISHEYE_PHOTOGRAPH_HEIGHT, NULL),
			 0);
	for (int k = 0; k < 9; k++) {
		struct fault fault = {""};
		struct image image;

		assert_int_equal(fisheye_photograph_board(&image, &board, &truth, k, &chance), 0);
		if (board_find(&board, &image, "board", &seen, &fault))
			print_message("# board %d: %s\n", k + 1, fault.text);
		else
			found++;
		image_free(&image);
	}
	assert_true(found >= 7);
	assert_int_equal(fisheye_find(&result, &seen, &wanted, NULL), 0);
	verdict_sentence(&result.finding.verdict, said, sizeof(said));
	most = seen_to(&seen, &truth);
	error = error_of(&truth, &result.lens, most);
	print_message("# %s: %d of 9 found; %s; rms %.3f px; off by %.3f px up to %.0f degrees\n",
		      fisheye_model_names[model], found, said, result.finding.rms_px, error,
		      most * 180 / M_PI);
	assert_true(result.finding.verdict.trusted);
	assert_true(error < 0.2);
	fisheye_result_free(&result);
	observations_free(&seen);
}

TEST("equidistant")
{
	photographs(FISHEYE_EQUIDISTANT, 220);
}

TEST("stereographic")
{
	photographs(FISHEYE_STEREOGRAPHIC, 175);
}
