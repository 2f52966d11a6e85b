/* SPDX-License-Identifier: MIT */
/* The edge spread that a camera's calibration finds, on boards drawn with a known one. */
#include <math.h>

#include "bake/calibrate/camera/camera_edges.h"
#include "tests/support/calibrate/drawn_board.h"
#include "tests/support/calibrate/known_camera.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"

static void measure(const char *text, double blur_px, double noise, double tilt,
		    struct camera_edges *edges)
{
	const double eye[3] = {0.09 + tilt, -0.25, 0.4}, target[3] = {0.09, -0.06, 0};
	const struct tsai_camera camera = known_camera(eye, target, -0.05, TSAI_DISTORTS);
	struct observations seen = {.width = 0};
	struct board board;
	struct drawn_board drawn = {
		.board = &board, .camera = &camera, .blur_px = blur_px, .noise = noise, .seed = 5};
	struct image picture;
	struct fault fault = {""};

	assert_int_equal(board_parse(&board, text, &fault), 0);
	assert_int_equal(drawn_board_draw(&drawn, &picture), 0);
	if (board_find(&board, &picture, "drawn", &seen, &fault))
		fail_msg("%s", fault.text);
	assert_int_equal(camera_edges_measure(&seen, &picture, &board, edges), 0);
	observations_free(&seen);
	image_free(&picture);
}

TEST("the spread of drawn boards is found")
{
	/* The drawing's Gaussian has samples at whole pixels, which is right from 0.6 px on.
	 * Markers of this size are not found at 2 px. */
	static const double sigmas[] = {0.6, 0.8, 1.2, 2};
	static const char *const boards[] = {"8x5:25mm", "charuco:9x6:25mm:18mm"};

	for (int b = 0; b < 2; b++)
		for (size_t k = 0; k < sizeof(sigmas) / sizeof(*sigmas) - (size_t)b; k++) {
			const double noise = k % 2 ? 2 : 0;
			struct camera_edges edges;

			if (!thorough() && k % 2 == (size_t)b)
				continue;
			measure(boards[b], sigmas[k], noise, 0.1 * (double)k, &edges);
			print_message("# %s sigma %g noise %g: %.3f +- %.3f px, %d edges\n",
				      boards[b], sigmas[k], noise, edges.sigma_px,
				      edges.deviation_px, edges.count);
			assert_true(edges.count >= 40);
			expect_that(fabs(edges.sigma_px / sigmas[k] - 1) < 0.1, "%s sigma %g: %g",
				    boards[b], sigmas[k], edges.sigma_px);
			assert_true(edges.deviation_px < 0.05 * sigmas[k]);
		}
}

TEST("sharp boards have no spread")
{
	struct camera_edges edges;

	measure("8x5:25mm", 0, 1, 0.1, &edges);
	assert_true(edges.count >= 40);
	expect_that(edges.sigma_px < 0.15, "%g", edges.sigma_px);
}

TEST("no points tell nothing")
{
	struct observations seen = {.width = 0};
	struct camera_edges edges = {.count = 3};
	struct board board;

	assert_int_equal(board_parse(&board, "9x6:25mm", NULL), 0);
	assert_int_equal(camera_edges_measure(&seen, NULL, &board, &edges), 0);
	assert_int_equal(edges.count, 0);
}
