/* SPDX-License-Identifier: MIT */
/* Cases in which a camera's calibration fails: each must get its verdict. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bake/calibrate/camera/camera_model.h"
#include "tests/support/calibrate/known_camera.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

static const double eye[3] = {0.12, -0.38, 0.42}, middle[3] = {0.01, 0.005, 0};
static const double above[3] = {0.0, -1e-4, 0.6};

/* Solves, and expects the verdict to trust (expected "") or to contain this text. */
static void test_verdict_expect(struct observations *seen, const struct camera_task *task,
				const char *expected)
{
	struct camera_solution solution;
	struct fault fault = {""};
	char sentence[600];

	assert_int_equal(camera_calibrate(seen, task, &solution, &fault), 0);
	verdict_sentence(&solution.finding.verdict, sentence, sizeof(sentence));
	if (*expected ? !strstr(sentence, expected) : !solution.finding.verdict.trusted)
		fail_msg("expected \"%s\", got \"%s\"", expected, sentence);
	assert_true(solution.finding.verdict.trusted == !*expected);
	/* a verdict that does not trust gives advice */
	assert_true(solution.finding.verdict.trusted || solution.finding.verdict.remedy[0]);
	camera_solution_free(&solution);
	observations_free(seen);
}

/* ---- how many ---- */

TEST("fewest points")
{
	struct chance chance = chance_begin("fewest");
	const struct tsai_camera truth = known_camera(eye, middle, 0, TSAI_DISTORTS);
	const struct camera_task task = known_camera_task(&truth);
	struct camera_task pose = camera_task_default();

	pose.intrinsics = &truth;
	for (int count = 3; count <= 4; count++) {
		const double wide[4][2] = {{-0.1, -0.1}, {0.1, -0.1}, {0.1, 0.1}, {-0.1, 0.1}};
		struct observations seen = {0};

		assert_int_equal(observations_begin_view(&seen, "few"), 0);
		for (int i = 0; i < count; i++)
			known_camera_see(&seen, &truth, (double[]){wide[i][0], wide[i][1], 0}, 0,
					 NULL);
		test_verdict_expect(&seen, &pose,
				    count < 4 ? "3 points are too few: points of one plane" : "");
	}
	for (int count = 6; count <= 7; count++) {
		struct observations seen = {0};

		known_camera_see_cloud(&seen, &truth, count, 0, &chance);
		test_verdict_expect(&seen, &pose,
				    count < 7 ? "6 points are too few: points in space" : "");
	}
	for (int count = 10; count <= 11; count++) {
		struct observations seen = {0};

		known_camera_see_cloud(&seen, &truth, count, 0, &chance);
		test_verdict_expect(&seen, &task, count < 11 ? "too few for a lens" : "");
	}
}

TEST("no points")
{
	const struct tsai_camera truth = known_camera(eye, middle, 0, TSAI_DISTORTS);
	const struct camera_task task = known_camera_task(&truth);
	struct observations seen = {0};

	assert_int_equal(observations_begin_view(&seen, "none"), 0);
	test_verdict_expect(&seen, &task, "no points");
}

TEST("no such reference")
{
	const struct tsai_camera truth = known_camera(eye, middle, 0, TSAI_DISTORTS);
	struct camera_task task = known_camera_task(&truth);
	struct camera_solution solution;
	struct observations seen = {0};
	struct fault fault = {""};

	task.reference = 1;
	known_camera_see_board(&seen, &truth, 9, 6, 0, NULL);
	assert_int_equal(camera_calibrate(&seen, &task, &solution, &fault), -EINVAL);
	assert_non_null(strstr(fault.text, "view 2"));
	camera_solution_free(&solution);
	observations_free(&seen);
}

/* ---- how they lie ---- */

/* With and without noise. A nearly parallel board is as bad as its noise makes it. */
TEST("board parallel to the picture")
{
	static const double noises[] = {0, 0.4, 1};
	struct chance chance = chance_begin("parallel");

	for (int n = 0; n < 9; n++)
		for (int tilt = 0; tilt < 2; tilt++) {
			const double from[3] = {tilt ? 0.01 : 0, tilt ? -0.01 : -1e-9, 0.6};
			const struct tsai_camera truth = known_camera(
				from, (double[]){0, 0, 0}, n / 3 ? -0.05 : 0, n / 3 == 2);
			const struct camera_task task = known_camera_task(&truth);
			struct observations seen = {0};

			if (tilt && !(noises[n % 3] > 0))
				continue;
			known_camera_see_board(&seen, &truth, 12, 9, noises[n % 3], &chance);
			test_verdict_expect(&seen, &task, "parallel to the image plane");
		}
}

TEST("nearly orthographic")
{
	struct chance chance = chance_begin("orthographic");

	for (int space = 0; space < 2; space++)
		for (int n = 0; n < 3; n++) {
			struct tsai_camera truth = known_camera((double[]){100, -300, 350}, middle,
								0, TSAI_DISTORTS);
			struct observations seen = {0};
			struct camera_task task;

			truth.focal *= 1000;
			task = known_camera_task(&truth);
			if (space)
				known_camera_see_cloud(&seen, &truth, 80, 0.3 + 0.3 * n, &chance);
			else
				known_camera_see_board(&seen, &truth, 12, 9, 0.3 + 0.3 * n,
						       &chance);
			test_verdict_expect(&seen, &task, "nearly orthographic");
		}
}

TEST("points on a line")
{
	const struct tsai_camera truth = known_camera(eye, middle, 0, TSAI_DISTORTS);
	const struct camera_task task = known_camera_task(&truth);
	struct observations seen = {0};

	assert_int_equal(observations_begin_view(&seen, "line"), 0);
	for (int i = 0; i < 20; i++)
		known_camera_see(&seen, &truth, (double[]){0.01 * i - 0.1, 0.004 * i - 0.04, 0}, 0,
				 NULL);
	test_verdict_expect(&seen, &task, "on a line");
}

TEST("points in a corner")
{
	struct chance chance = chance_begin("corner");
	const struct tsai_camera truth = known_camera(eye, middle, 0.05, TSAI_DISTORTS);
	const struct camera_task task = known_camera_task(&truth);

	for (int n = 0; n < 2; n++) {
		struct observations seen = {0};

		assert_int_equal(observations_begin_view(&seen, "corner"), 0);
		for (int i = 0; i < 36; i++)
			known_camera_see(&seen, &truth,
					 (double[]){0.1 + 0.008 * (i % 6), 0.1 + 0.008 * (i / 6),
						    n ? 0.01 * ((i * 7) % 5) : 0},
					 0, &chance);
		test_verdict_expect(&seen, &task, "in one corner");
	}
}

/* s is held at 1: what lies on the board is drawn right all the same, but what stands up from it
 * only where pixels are known to be square. */
TEST("aspect does not show in a plane")
{
	struct chance chance = chance_begin("aspect");
	const struct tsai_camera truth = known_camera(eye, middle, -0.1, TSAI_DISTORTS);
	struct camera_task task = known_camera_task(&truth);
	struct observations seen = {0};

	task.aspect_deviation = 0.05;
	known_camera_see_board(&seen, &truth, 12, 9, 0.1, &chance);
	test_verdict_expect(&seen, &task, "do not tell whether the pixels are square");
	known_camera_see_board(&seen, &truth, 12, 9, 0.1, &chance);
	task.object_given = true;
	test_verdict_expect(&seen, &task, "");
	task.object_given = false;
	for (int way = 0; way < 2; way++) {
		struct camera_solution solution;

		known_camera_see_board(&seen, &truth, 12, 9, 0.1, &chance);
		task.aspect_given = way;
		task.aspect_deviation = -1;
		assert_int_equal(camera_calibrate(&seen, &task, &solution, NULL), 0);
		assert_true(solution.finding.estimate.parameter[MODEL_ASPECT].fixed);
		expect_equal(solution.camera.aspect, 1, "way=%d", way);
		expect_that(known_camera_trusted(&solution), "way=%d", way);
		camera_solution_free(&solution);
		observations_free(&seen);
	}
}

/* ---- what is wrong with them ---- */

static struct observations board_seen(const struct tsai_camera *truth, double noise,
				      struct chance *chance)
{
	struct observations seen = {0};

	known_camera_see_board(&seen, truth, 12, 9, noise, chance);
	return seen;
}

TEST("outliers")
{
	struct chance chance = chance_begin("outliers");
	const struct tsai_camera truth = known_camera(eye, middle, -0.1, TSAI_DISTORTS);
	struct camera_task task = known_camera_task(&truth);
	struct observations seen;

	/* one outlier: named, with advice how to go on */
	seen = board_seen(&truth, 0.1, &chance);
	seen.point[17].px[0] += 30;
	test_verdict_expect(&seen, &task, "point 18 is");
	/* a few outliers, robustly: trusted, and they are named */
	task.robust = true;
	for (int count = 1; count <= 20; count += 6) {
		struct camera_solution solution;

		seen = board_seen(&truth, 0.1, &chance);
		for (int k = 0; k < count; k++) {
			seen.point[5 * k].px[0] += k % 2 ? 30 : -12;
			seen.point[5 * k].px[1] += k % 3 ? 20 : 5;
		}
		assert_int_equal(camera_calibrate(&seen, &task, &solution, NULL), 0);
		expect_that(known_camera_trusted(&solution), "count=%d", count);
		for (int i = 0; i < seen.count; i++)
			expect_equal((solution.finding.weight[i] < 0.1),
				     (i % 5 == 0 && i < 5 * count), "count=%d, i=%d", count, i);
		expect_below(fabs(solution.camera.focal / truth.focal - 1), 0.02, "count=%d",
			     count);
		camera_solution_free(&solution);
		observations_free(&seen);
	}
	/* too many outliers */
	seen = board_seen(&truth, 0.1, &chance);
	for (int i = 0; i < seen.count; i += 3)
		seen.point[i].px[0] += 20 + i % 7;
	test_verdict_expect(&seen, &task, "do not fit the others");
}

TEST("points in another order")
{
	struct chance chance = chance_begin("order");
	const struct tsai_camera truth = known_camera(eye, middle, 0, TSAI_DISTORTS);
	const struct camera_task task = known_camera_task(&truth);
	struct observations seen = board_seen(&truth, 0.1, &chance);

	for (int i = 0; i < seen.count; i++) {
		const int j = (i * 37) % seen.count;
		double swap[2];

		memcpy(swap, seen.point[i].px, sizeof(swap));
		memcpy(seen.point[i].px, seen.point[j].px, sizeof(swap));
		memcpy(seen.point[j].px, swap, sizeof(swap));
	}
	test_verdict_expect(&seen, &task, ";");
}

/* A mirrored board is one seen from behind; mirrored points in space fit no camera, which is not
 * trusted and told to look at --y-up. */
TEST("mirrored")
{
	struct chance chance = chance_begin("mirrored");

	for (int space = 0; space < 2; space++)
		for (int n = 0; n < 4; n++) {
			const struct tsai_camera truth = known_camera(eye, middle,
								      n % 2 ? -0.05 : 0, n / 2);
			struct camera_task task = known_camera_task(&truth);
			struct observations seen = {0};

			if (space)
				known_camera_see_cloud(&seen, &truth, 60, 0.1, &chance);
			else
				known_camera_see_board(&seen, &truth, 12, 9, 0.1, &chance);
			for (int i = 0; i < seen.count; i++)
				seen.point[i].px[1] = KNOWN_CAMERA_HEIGHT - seen.point[i].px[1];
			test_verdict_expect(&seen, &task, "--y-up");
		}
}

TEST("listed twice")
{
	struct chance chance = chance_begin("twice");
	const struct tsai_camera truth = known_camera(eye, middle, 0, TSAI_DISTORTS);
	const struct camera_task task = known_camera_task(&truth);
	struct observations seen = board_seen(&truth, 0.1, &chance);
	const struct observation first = seen.point[3];

	assert_int_equal(observations_add(&seen, first.world, first.px, "again"), 0);
	test_verdict_expect(&seen, &task, "point 4 and again are one point listed twice");
}

/* A view of something else has no pose, however well the other views fit. */
TEST("view of outliers")
{
	const struct tsai_camera truth = known_camera(eye, middle, -0.1, TSAI_DISTORTS);
	const double other[5][3] = {{0.3, -0.2, 0.4},
				    {-0.3, -0.25, 0.4},
				    {0.1, 0.4, 0.4},
				    {0, 0.2, 0.5},
				    {0.2, 0, 0.5}};
	struct chance chance = chance_begin("view");
	struct camera_task task = known_camera_task(&truth);
	struct observations seen = {0};

	known_camera_see_board(&seen, &truth, 5, 5, 0.1, &chance);
	for (int i = 0; i < seen.count; i++)
		for (int k = 0; k < 2 && i % 5 < 3; k++)
			seen.point[i].px[k] += chance_real(&chance, 20, 60);
	for (int v = 0; v < 5; v++) {
		const struct tsai_camera from = known_camera(other[v], middle, -0.1, TSAI_DISTORTS);

		known_camera_see_board(&seen, &from, 5, 5, 0.1, &chance);
	}
	task.robust = true;
	test_verdict_expect(&seen, &task, "points of board do not fit the other views");
}

/* A plane alone does not tell the axis: what stands up from it may be wrong. */
TEST("axis does not show")
{
	struct chance chance = chance_begin("axis");
	const struct tsai_camera truth = known_camera(eye, middle, 0, TSAI_DISTORTS);
	struct camera_task task = known_camera_task_of_plane(&truth);
	struct observations seen = board_seen(&truth, 0.1, &chance);

	task.object_given = true;
	task.object_radius = 0.1;
	task.tolerance_px = 0.3;
	test_verdict_expect(&seen, &task, "do not tell where the lens's axis is");
	seen = board_seen(&truth, 0.1, &chance);
	task.centre_deviation_px = 1;
	test_verdict_expect(&seen, &task, "");
}

/* The reader refuses points that are NaN. */
TEST("not a number")
{
	static const char *const lines[] = {"0 0 0 nan 4\n", "0 0 inf 3 4\n", "0 0 0 3\n"};
	const struct points_convention convention = {.pixel_centre = 0.5};

	for (int k = 0; k < 3; k++) {
		char path[] = "/tmp/inlay-points-XXXXXX";
		struct observations seen = {0};
		struct fault fault = {""};
		FILE *file = fdopen(mkstemp(path), "w");

		assert_non_null(file);
		fprintf(file, "1 2 3 4 5\n%s", lines[k]);
		assert_int_equal(fclose(file), 0);
		expect_equal(observations_read(&seen, path, &convention, &fault), -EINVAL, "k=%d",
			     k);
		assert_non_null(strstr(fault.text, ":2: expected five finite numbers"));
		assert_int_equal(unlink(path), 0);
		observations_free(&seen);
	}
}

/* ---- distortion ---- */

/* Up to just before the fold all is well; points that no kappa1 explains are refused. */
TEST("folds over")
{
	struct chance chance = chance_begin("fold");

	for (int distortion = 0; distortion < 2; distortion++) {
		/* radius of the board's outermost point, as a share of the fold's radius */
		static const double parts[] = {0.5, 0.8, 0.9};

		for (int p = 0; p < 3; p++) {
			struct tsai_camera truth = known_camera(eye, middle, 0, distortion);
			struct observations seen = {0};
			struct camera_task task;
			double farthest = 0;

			known_camera_see_board(&seen, &truth, 12, 9, 0, &chance);
			for (int i = 0; i < seen.count; i++)
				farthest = fmax(
					farthest,
					hypot(seen.point[i].px[0] - KNOWN_CAMERA_WIDTH / 2.0,
					      seen.point[i].px[1] - KNOWN_CAMERA_HEIGHT / 2.0) *
						truth.pixel[0]);
			/* undistorted radius over its largest value: the fold, or 2/3 of it */
			truth.kappa1 = -pow(parts[p] / farthest, 2) / 3;
			if (distortion)
				truth.kappa1 *= 4.0 / 9;
			observations_free(&seen);
			known_camera_see_board(&seen, &truth, 12, 9, 0, &chance);
			expect_equal(seen.count, 108, "distortion=%d, p=%d", distortion, p);
			task = known_camera_task(&truth);
			task.object_given = true;
			test_verdict_expect(&seen, &task, "");
		}
	}
}

TEST("lens beyond its model")
{
	struct chance chance = chance_begin("beyond");
	const struct tsai_camera truth = known_camera(eye, middle, 0, TSAI_DISTORTS);
	const struct camera_task task = known_camera_task(&truth);
	struct observations seen = board_seen(&truth, 0.05, &chance);

	/* an equidistant fisheye of half the focal length is no Tsai camera */
	for (int i = 0; i < seen.count; i++) {
		double *px = seen.point[i].px;
		const double x = px[0] - 320, y = px[1] - 240, r = hypot(x, y);
		const double bent = 130 * atan(r / 130) * (r > 130 ? 0.8 : 1);

		px[0] = 320 + x * bent / r;
		px[1] = 240 + y * bent / r;
	}
	test_verdict_expect(&seen, &task, ";");
}

/* ---- the object ---- */

TEST("object beyond the points")
{
	struct chance chance = chance_begin("object");
	const struct tsai_camera truth = known_camera(eye, middle, -0.05, TSAI_DISTORTS);
	struct camera_task task = known_camera_task(&truth);
	struct observations seen = {0};

	task.object_given = true;
	/* on the board, then far beside it, then behind the camera */
	known_camera_see_board(&seen, &truth, 9, 6, 0.02, &chance);
	test_verdict_expect(&seen, &task, "");
	task.object[0] = 0.28;
	task.tolerance_px = 100;
	known_camera_see_board(&seen, &truth, 9, 6, 0.02, &chance);
	test_verdict_expect(&seen, &task, "outside of what the points cover");
	task.object[1] = -5;
	task.object[2] = 3;
	known_camera_see_board(&seen, &truth, 9, 6, 0.02, &chance);
	test_verdict_expect(&seen, &task, "no image of the object's place");
}

TEST("object too uncertain")
{
	struct chance chance = chance_begin("uncertain");
	const struct tsai_camera truth = known_camera(eye, middle, -0.05, TSAI_DISTORTS);
	struct camera_task task = known_camera_task_of_plane(&truth);
	struct camera_solution solution;
	struct observations seen = {0};
	char sentence[600];

	task.centre_deviation_px = 0;
	task.tolerance_px = 0.01;
	known_camera_see_board(&seen, &truth, 9, 6, 0.5, &chance);
	/* the first of the figures, by its name and number */
	assert_int_equal(camera_calibrate(&seen, &task, &solution, NULL), 0);
	assert_string_equal(solution.finding.figure[0].key, "object_error_px");
	snprintf(sentence, sizeof(sentence),
		 "the %s is %.6g px, more than the 0.01 px of --tolerance",
		 solution.finding.figure[0].label, solution.finding.figure[0].value);
	camera_solution_free(&solution);
	test_verdict_expect(&seen, &task, sentence);
	task.tolerance_px = 100;
	known_camera_see_board(&seen, &truth, 9, 6, 0.5, &chance);
	test_verdict_expect(&seen, &task, "");
}

/* With a known lens, a board parallel to the picture is as good as any; only its tilt is less
 * certain. */
TEST("parallel is no matter for a known lens")
{
	struct chance chance = chance_begin("known");
	const struct tsai_camera truth = known_camera(above, (double[]){0, 0, 0}, 0, TSAI_DISTORTS);
	struct camera_task task = camera_task_default();
	struct observations seen = {0};

	task.intrinsics = &truth;
	known_camera_see_board(&seen, &truth, 12, 9, 0.1, &chance);
	test_verdict_expect(&seen, &task, "");
}

/* From afar a board looks the same tilted the other way: a pose that may be either is doubted. */
TEST("other tilt from afar")
{
	struct chance chance = chance_begin("other tilt");
	int wrong = 0;

	for (int run = 0; run < 40; run++) {
		struct camera_task task = camera_task_default();
		struct observations seen = {0};
		struct camera_solution solution;
		struct tsai_camera truth;
		double from[3], cosine = 0;
		bool other;

		chance_direction(&chance, 0.5, from);
		for (int k = 0; k < 3; k++)
			from[k] *= 8;
		truth = known_camera(from, middle, -0.05, run & 1);
		task.intrinsics = &truth;
		known_camera_see_board(&seen, &truth, 9, 6, 0.2, &chance);
		assert_int_equal(camera_calibrate(&seen, &task, &solution, NULL), 0);
		for (int k = 0; k < 3; k++)
			cosine += truth.rotation[3 * k + 2] * solution.camera.rotation[3 * k + 2];
		other = cosine < cos(5 * M_PI / 180);
		wrong += other;
		expect_that(!other || !solution.finding.verdict.trusted, "run=%d", run);
		camera_solution_free(&solution);
		observations_free(&seen);
	}
	print_message("# %d of 40 are tilted the other way\n", wrong);
}
