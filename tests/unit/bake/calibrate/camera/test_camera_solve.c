/* SPDX-License-Identifier: MIT */
/* Calibration of Tsai's camera: known cameras come back, and the reported deviations are true. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bake/calibrate/camera/camera_model.h"
#include "bake/calibrate/estimate/rotation.h"
#include "hal/optics/vec.h"
#include "tests/support/calibrate/known_camera.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"

static const double eyes[5][3] = {{0.12, -0.38, 0.42},
				  {-0.3, -0.2, 0.5},
				  {0.35, 0.05, 0.45},
				  {0.05, 0.4, 0.4},
				  {-0.15, 0.3, 0.55}};
static const double middle[3] = {0.01, 0.005, 0};

/* ---- the model's slopes ---- */

TEST("slopes are differences")
{
	struct chance chance = chance_begin("camera slopes");

	for (int n = 0; n < 400; n++) {
		const bool more = n & 4; /* of terms */
		const struct camera_model model = {.pixel = {0.01, 0.012},
						   .distortion = n & 1,
						   .tangential = {more * 1e-3, more * -2e-3},
						   .reach = 4};
		double x[MODEL_GRADIENT] = {[MODEL_FOCAL] = 8,
					    [MODEL_KAPPA1] = (n & 2 ? -1 : 1) * 2e-3,
					    [MODEL_KAPPA1 + 1] = more * (n & 8 ? -1 : 1) * 1e-4,
					    [MODEL_KAPPA1 + 2] = more * 1e-5,
					    [MODEL_CENTRE_X] = 320,
					    [MODEL_CENTRE_Y] = 240,
					    [MODEL_ASPECT] = 1.02};
		double place[3], px[2], gradient[2][MODEL_GRADIENT];
		const double size = n % 7 ? chance_real(&chance, 0, 3) : 1e-5;
		struct model_view view;

		chance_direction(&chance, -1, x + MODEL_SHARED);
		for (int k = 0; k < 3; k++) {
			x[MODEL_SHARED + k] *= size;
			x[MODEL_SHARED + MODEL_TRANSLATION + k] = chance_real(&chance, -0.2, 0.2) +
								  (k == 2) * 3;
			place[k] = chance_real(&chance, -0.7, 0.7);
		}
		model_turn(&view, x + MODEL_SHARED);
		expect_that(model_see(&model, x, &view, place, px, gradient), "n=%d", n);
		for (int k = 0; k < MODEL_GRADIENT; k++) {
			const double was = x[k], step = 1e-6 * fmax(fabs(x[k]), 1e-2);
			double ahead[2], behind[2];

			x[k] = was + step;
			model_turn(&view, x + MODEL_SHARED);
			expect_that(model_see(&model, x, &view, place, ahead, NULL), "n=%d, k=%d",
				    n, k);
			x[k] = was - step;
			model_turn(&view, x + MODEL_SHARED);
			expect_that(model_see(&model, x, &view, place, behind, NULL), "n=%d, k=%d",
				    n, k);
			x[k] = was;
			for (int i = 0; i < 2; i++) {
				const double slope = (ahead[i] - behind[i]) / (2 * step);

				expect_below(fabs(slope - gradient[i][k]),
					     1e-5 * (fabs(slope) + 1) + 1e-9 / step,
					     "n=%d, k=%d, i=%d", n, k, i);
			}
		}
	}
}

TEST("vectors of rotations")
{
	struct chance chance = chance_begin("camera rotations");

	for (int n = 0; n < 3000; n++) {
		static const double sizes[] = {0, 1e-12, 1e-6, 0.009, 0.011, 1, 3.1415, M_PI};
		double vector[3], rotation[9], slope[3][9], back[3], again[9];
		const double size = n % 9 < 8 ? sizes[n % 9] : chance_real(&chance, 0, M_PI);

		chance_direction(&chance, -1, vector);
		for (int k = 0; k < 3; k++)
			vector[k] *= size;
		rotation_from_vector(vector, rotation, slope);
		for (int i = 0; i < 3; i++)
			for (int j = 0; j < 3; j++)
				expect_below(fabs(vec_dot(rotation + 3 * i, rotation + 3 * j) -
						  (i == j)),
					     1e-14, "n=%d, i=%d, j=%d", n, i, j);
		rotation_to_vector(rotation, back);
		expect_below(vec_length(back), M_PI + 1e-9, "n=%d", n);
		rotation_from_vector(back, again, slope);
		for (int k = 0; k < 9; k++)
			expect_below(fabs(again[k] - rotation[k]), 1e-14, "n=%d, k=%d", n, k);
	}
}

/* ---- without noise ---- */

static void assert_camera(const struct tsai_camera *found, const struct tsai_camera *truth,
			  double accuracy)
{
	const double distance = vec_length(truth->translation);

	assert_true(fabs(found->focal / truth->focal - 1) < accuracy);
	assert_true(fabs(found->kappa1 - truth->kappa1) <=
		    accuracy * fmax(fabs(truth->kappa1), 3e-8));
	assert_true(fabs(found->aspect / truth->aspect - 1) < accuracy);
	for (int k = 0; k < 2; k++)
		expect_below(fabs(found->centre_px[k] - truth->centre_px[k]),
			     accuracy * KNOWN_CAMERA_WIDTH, "k=%d", k);
	for (int k = 0; k < 9; k++)
		expect_below(fabs(found->rotation[k] - truth->rotation[k]), accuracy, "k=%d", k);
	for (int k = 0; k < 3; k++)
		expect_below(fabs(found->translation[k] - truth->translation[k]),
			     accuracy * distance, "k=%d", k);
}

/* Points without noise give the true camera, which is trusted. */
static void assert_solved(struct observations *seen, const struct camera_task *task,
			  const struct tsai_camera *truth)
{
	struct camera_solution solution;

	assert_int_equal(camera_calibrate(seen, task, &solution, NULL), 0);
	assert_true(solution.solved);
	assert_camera(&solution.camera, truth, 1e-6);
	assert_true(known_camera_trusted(&solution));
	camera_solution_free(&solution);
	observations_free(seen);
}

/* Distortion at the corner of the picture; in the thesis's direction the fold is at -1/3. */
static const double bends[] = {0, 0.02, -0.02, 0.15, -0.12, 0.6, -0.2};

/* Calls solve for each direction of the distortion, each bend and each of five places. */
static void over_cameras(void (*solve)(struct tsai_camera *truth, struct chance *chance),
			 struct chance *chance)
{
	for (int distortion = 0; distortion < 2; distortion++)
		for (unsigned b = 0; b < sizeof(bends) / sizeof(*bends); b++)
			for (int e = 0; e < 5; e += thorough() ? 1 : 2) {
				struct tsai_camera truth = known_camera(eyes[e], middle, bends[b],
									distortion);

				solve(&truth, chance);
			}
}

static void solve_one_plane(struct tsai_camera *truth, struct chance *chance)
{
	const bool straight = truth->kappa1 == 0; /* then no picture tells the axis */
	struct observations seen = {0};
	struct camera_task task;

	truth->centre_px[0] += straight ? 0 : 9;
	truth->centre_px[1] -= straight ? 0 : 6;
	task = known_camera_task(truth);
	if (straight)
		task.centre_deviation_px = 0;
	known_camera_see_board(&seen, truth, 12, 9, 0, chance);
	assert_solved(&seen, &task, truth);
}

TEST("one plane")
{
	struct chance chance = chance_begin("camera plane");

	over_cameras(solve_one_plane, &chance);
}

static void solve_points_in_space(struct tsai_camera *truth, struct chance *chance)
{
	struct observations seen = {0};
	struct camera_task task;

	truth->aspect = 1.04;
	truth->centre_px[0] += 9;
	truth->centre_px[1] -= 6;
	task = known_camera_task(truth);
	known_camera_see_cloud(&seen, truth, 60, 0, chance);
	assert_solved(&seen, &task, truth);
}

TEST("points in space")
{
	struct chance chance = chance_begin("camera space");

	over_cameras(solve_points_in_space, &chance);
}

TEST("several boards")
{
	struct chance chance = chance_begin("camera boards");

	for (int distortion = 0; distortion < 2; distortion++)
		for (unsigned b = 0; b < sizeof(bends) / sizeof(*bends); b++) {
			struct tsai_camera truth[5];
			struct observations seen = {0};
			struct camera_solution solution;
			struct camera_task task;

			for (int e = 0; e < 5; e++) {
				/* No horizon of a plane may lie along the rows in every view:
				 * without distortion, s would not show. */
				truth[e] = known_camera_roll(
					known_camera(eyes[e], middle, bends[b], distortion),
					0.6 * e);
				truth[e].aspect = 0.97;
				truth[e].centre_px[0] += 9;
				truth[e].centre_px[1] -= 6;
				known_camera_see_board(&seen, &truth[e], 9, 6, 0, &chance);
			}
			task = known_camera_task(&truth[0]);
			task.reference = 3;
			assert_int_equal(camera_calibrate(&seen, &task, &solution, NULL), 0);
			for (int e = 0; e < 5; e++)
				assert_camera(&solution.view[e], &truth[e], 1e-6);
			assert_camera(&solution.camera, &truth[3], 1e-6);
			expect_that(known_camera_trusted(&solution), "distortion=%d, b=%u",
				    distortion, b);
			camera_solution_free(&solution);
			observations_free(&seen);
		}
}

static void solve_pose(struct tsai_camera *truth, struct chance *chance)
{
	struct tsai_camera lens = *truth;
	struct observations seen = {0};
	struct camera_task task = camera_task_default();

	lens.translation[2] = 1; /* the pose of the intrinsics is not used */
	task.intrinsics = &lens;
	known_camera_see_board(&seen, truth, 5, 4, 0, chance);
	assert_solved(&seen, &task, truth);
}

/* With the lens known, one board says where the camera is; the smallest board, too. */
TEST("pose alone")
{
	struct chance chance = chance_begin("camera pose");

	over_cameras(solve_pose, &chance);
}

/* ---- the world's units and axes ---- */

/* The same picture from a world that is scaled and shifted. */
TEST("units and places do not matter")
{
	static const double scales[] = {1e-9, 1e-3, 1, 1000, 1e6};
	const double offset[3] = {1e6, -2e6, 5e5};
	struct chance chance = chance_begin("camera units");
	const struct tsai_camera truth = known_camera(eyes[0], middle, -0.05, TSAI_DISTORTS);
	struct observations seen = {0};
	struct camera_solution first;
	struct camera_task task = known_camera_task(&truth);

	known_camera_see_board(&seen, &truth, 12, 9, 0.2, &chance);
	assert_int_equal(camera_calibrate(&seen, &task, &first, NULL), 0);
	for (unsigned s = 0; s < 5; s++)
		for (int moved = 0; moved < 2; moved++) {
			struct observations other = {0};
			struct camera_solution solution;
			const double *px_now;

			assert_int_equal(observations_begin_view(&other, "other"), 0);
			for (int i = 0; i < seen.count; i++) {
				double world[3];

				for (int k = 0; k < 3; k++)
					world[k] = scales[s] * (seen.point[i].world[k] +
								(moved ? offset[k] : 0));
				assert_int_equal(
					observations_add(&other, world, seen.point[i].px, "p"), 0);
			}
			assert_int_equal(camera_calibrate(&other, &task, &solution, NULL), 0);
			expect_that(known_camera_trusted(&solution), "s=%u, moved=%d", s, moved);
			/* at 1e6 m, double resolves 1e-10 m; the board is seen from 0.5 m */
			expect_below(fabs(solution.camera.focal / first.camera.focal - 1),
				     (moved ? 1e-5 : 1e-7), "s=%u, moved=%d", s, moved);
			for (int i = 0; i < seen.count; i++) {
				px_now = solution.finding.expected[i];
				expect_below(hypot(px_now[0] - first.finding.expected[i][0],
						   px_now[1] - first.finding.expected[i][1]),
					     (moved ? 1e-4 : 1e-6), "s=%u, moved=%d, i=%d", s,
					     moved, i);
			}
			camera_solution_free(&solution);
			observations_free(&other);
		}
	camera_solution_free(&first);
	observations_free(&seen);
}

/* A file with y upwards and pixel centres at whole numbers describes the same picture. */
TEST("y up is the same picture")
{
	static const struct points_convention down = {.pixel_centre = 0.5};
	static const struct points_convention up = {
		.height = KNOWN_CAMERA_HEIGHT, .y_up = 1, .pixel_centre = 0};
	struct chance chance = chance_begin("camera y up");
	const struct tsai_camera truth = known_camera(eyes[0], middle, -0.05, TSAI_DISTORTS);
	const struct camera_task task = known_camera_task(&truth);
	struct observations seen = {0};
	struct camera_solution solution[2];

	known_camera_see_board(&seen, &truth, 12, 9, 0.2, &chance);
	for (int way = 0; way < 2; way++) {
		char path[] = "/tmp/inlay-points-XXXXXX";
		FILE *file = fdopen(mkstemp(path), "w");
		struct observations read = {0};

		assert_non_null(file);
		for (int i = 0; i < seen.count; i++) {
			const double *w = seen.point[i].world, *px = seen.point[i].px;

			fprintf(file, "%.17g %.17g %.17g %.17g %.17g\n", w[0], w[1], w[2],
				way ? px[0] - 0.5 : px[0],
				way ? KNOWN_CAMERA_HEIGHT - px[1] - 0.5 : px[1]);
		}
		assert_int_equal(fclose(file), 0);
		assert_int_equal(observations_read(&read, path, way ? &up : &down, NULL), 0);
		assert_int_equal(unlink(path), 0);
		assert_int_equal(camera_calibrate(&read, &task, &solution[way], NULL), 0);
		expect_that(known_camera_trusted(&solution[way]), "way=%d", way);
		observations_free(&read);
	}
	assert_camera(&solution[1].camera, &solution[0].camera, 1e-6);
	for (int way = 0; way < 2; way++)
		camera_solution_free(&solution[way]);
	observations_free(&seen);
}

/* Any plane in space, with the origin anywhere: on the axis, where Ty is 0, and far away. */
TEST("any plane any origin")
{
	struct chance chance = chance_begin("camera planes");

	for (int n = 0; n < (thorough() ? 200 : 60); n++) {
		struct tsai_camera truth = known_camera(
			eyes[n % 5], n % 4 ? middle : (double[]){0, 0, 0}, -0.06, n & 1);
		struct observations seen = {0}, other = {0};
		struct camera_solution solution;
		struct camera_task task;
		double vector[3], turn[9], slope[3][9], shift[3], moved[3];

		if (n % 4 == 0) { /* the world's origin lies on the axis: Tx = Ty = 0 */
			expect_below(fabs(truth.translation[1]), 1e-12, "n=%d", n);
		} else {
			truth.centre_px[0] += 4;
		}
		task = known_camera_task(&truth);
		known_camera_see_board(&seen, &truth, 12, 9, 0, &chance);
		chance_direction(&chance, -1, vector);
		for (int k = 0; k < 3; k++) {
			vector[k] *= n % 3 ? chance_real(&chance, 0, 3) : 0;
			shift[k] = n % 5 && n % 4 ? chance_real(&chance, -10, 10) : 0;
		}
		rotation_from_vector(vector, turn, slope);
		assert_int_equal(observations_begin_view(&other, "turned"), 0);
		for (int i = 0; i < seen.count; i++) {
			double world[3];

			mat_apply(turn, seen.point[i].world, world);
			for (int k = 0; k < 3; k++)
				world[k] += shift[k];
			assert_int_equal(observations_add(&other, world, seen.point[i].px, "p"), 0);
		}
		/* the true camera in the turned world: R turn^T, T - R turn^T shift */
		for (int i = 0; i < 3; i++) {
			double row[3];

			mat_apply(turn, truth.rotation + 3 * i, row);
			memcpy(truth.rotation + 3 * i, row, sizeof(row));
		}
		mat_apply(truth.rotation, shift, moved);
		for (int k = 0; k < 3; k++)
			truth.translation[k] -= moved[k];
		assert_int_equal(camera_calibrate(&other, &task, &solution, NULL), 0);
		assert_camera(&solution.camera, &truth, 1e-6);
		camera_solution_free(&solution);
		observations_free(&seen);
		observations_free(&other);
	}
}

/* ---- noise ---- */

struct deviation_tally {
	int runs, one, two, three;
};

static void count_parameter(struct deviation_tally *tally, const struct estimate *estimate,
			    const char *name, double truth)
{
	const int k = estimate_find(estimate, name);
	double off;

	assert_true(k >= 0);
	if (estimate->parameter[k].fixed)
		return;
	off = fabs(estimate->parameter[k].value - truth) / estimate_deviation(estimate, k);
	tally->runs++;
	tally->one += off < 1;
	tally->two += off < 1.959964;
	tally->three += off < 3;
}

/*
 * Checks that the right shares of runs lie within one and two deviations, to five binomial
 * deviations, and that 99 of 100 lie within three, or as many as chance allows in few runs. Each of
 * 11 numbers is checked at each of four noises: one of them is beyond four deviations in up to 3 %
 * of all seeds, beyond five in 0.2 %.
 * `slack` is the share of runs by which second-order errors may move the counts.
 */
static void assert_nearly_honest(const struct deviation_tally *tally, double slack)
{
	const double n = tally->runs;

	assert_true(n > 0);
	assert_true(fabs(tally->one - 0.6827 * n) < 5 * sqrt(n * 0.6827 * 0.3173) + slack * n);
	assert_true(fabs(tally->two - 0.95 * n) < 5 * sqrt(n * 0.95 * 0.05) + slack * n);
	assert_true(tally->three >= 0.99 * n - (n < 1000 ? 4 * sqrt(n * 0.99 * 0.01) : 0));
}

static void assert_honest(const struct deviation_tally *tally)
{
	assert_nearly_honest(tally, 0);
}

enum { OF_FOCAL, OF_KAPPA, OF_CENTRE_X, OF_CENTRE_Y, OF_ASPECT, OF_POSE, TALLIES = OF_POSE + 6 };

static void count_all(struct deviation_tally tally[TALLIES], const struct camera_solution *solution,
		      const struct tsai_camera *truth, const char *view)
{
	static const char *const pose[] = {"rotation x",    "rotation y",    "rotation z",
					   "translation x", "translation y", "translation z"};
	const struct estimate *estimate = &solution->finding.estimate;
	double vector[3];

	rotation_to_vector(truth->rotation, vector);
	count_parameter(&tally[OF_FOCAL], estimate, "focal", truth->focal);
	count_parameter(&tally[OF_KAPPA], estimate, "kappa1", truth->kappa1);
	count_parameter(&tally[OF_CENTRE_X], estimate, "centre x", truth->centre_px[0]);
	count_parameter(&tally[OF_CENTRE_Y], estimate, "centre y",
			truth->height - truth->centre_px[1]);
	count_parameter(&tally[OF_ASPECT], estimate, "aspect", truth->aspect);
	for (int k = 0; k < 6; k++) {
		char name[64];

		snprintf(name, sizeof(name), "%s%s", view, pose[k]);
		count_parameter(&tally[OF_POSE + k], estimate, name,
				k < 3 ? vector[k] : truth->translation[k - 3]);
	}
}

/* Runs for each noise: INLAY_RUNS, or a small number. Bounds widen with fewer runs. */
static int runs_of_test(void)
{
	const char *text = getenv("INLAY_RUNS");

	return text ? atoi(text) : thorough() ? 80 : 12;
}

TEST("deviations are honest")
{
	static const double noises[] = {0.02, 0.3, 1, 2};
	struct chance chance = chance_begin("camera noise");
	const int runs = runs_of_test();

	for (int n = 0; n < 4; n++) {
		struct deviation_tally tally[TALLIES] = {{0}};

		for (int run = 0; run < runs; run++) {
			struct tsai_camera truth[3];
			struct observations seen = {0};
			struct camera_solution solution;
			struct camera_task task;

			for (int e = 0; e < 3; e++) {
				truth[e] = known_camera_roll(
					known_camera(eyes[e], middle, -0.08, run & 1), 0.6 * e);
				truth[e].centre_px[0] += 7;
				known_camera_see_board(&seen, &truth[e], 12, 9, noises[n], &chance);
			}
			task = known_camera_task(&truth[0]);
			task.aspect_deviation = 0.05; /* nothing else fixes the aspect */
			assert_int_equal(camera_calibrate(&seen, &task, &solution, NULL), 0);
			assert_true(solution.solved);
			count_all(tally, &solution, &truth[0], "view 1 ");
			camera_solution_free(&solution);
			observations_free(&seen);
		}
		for (int k = 0; k < TALLIES; k++) {
			if (getenv("INLAY_RUNS"))
				printf("# noise %g, parameter %d: %d %d %d of %d\n", noises[n], k,
				       tally[k].one, tally[k].two, tally[k].three, tally[k].runs);
			assert_honest(&tally[k]);
		}
	}
}

/* The same for points in space, and for a pose alone. */
TEST("deviations of space and pose")
{
	struct chance chance = chance_begin("camera noise");
	const int runs = runs_of_test();

	for (int known = 0; known < 2; known++) {
		struct deviation_tally tally[TALLIES] = {{0}};

		for (int run = 0; run < runs; run++) {
			struct tsai_camera truth = known_camera(eyes[run % 5], middle, -0.08,
								run & 1);
			struct observations seen = {0};
			struct camera_solution solution;
			struct camera_task task;

			truth.aspect = 1.04;
			task = known ? camera_task_default() : known_camera_task(&truth);
			task.intrinsics = known ? &truth : NULL;
			if (known)
				known_camera_see_board(&seen, &truth, 9, 6, 0.3, &chance);
			else
				known_camera_see_cloud(&seen, &truth, 150, 0.3, &chance);
			assert_int_equal(camera_calibrate(&seen, &task, &solution, NULL), 0);
			expect_that(known_camera_trusted(&solution), "known=%d, run=%d", known,
				    run);
			count_all(tally, &solution, &truth, "");
			camera_solution_free(&solution);
			observations_free(&seen);
		}
		for (int k = known ? OF_POSE : 0; k < TALLIES; k++)
			assert_honest(&tally[k]);
	}
}

/* From afar, with outliers: the result fits as well as the truth, in spite of wrong minima on the
 * way. */
TEST("no wrong minimum")
{
	struct chance chance = chance_begin("camera minima");

	for (int run = 0; run < (thorough() ? 12 : 4); run++) {
		struct tsai_camera truth = known_camera((double[]){3, -5, 6}, (double[]){0, 0, 0},
							0, TSAI_UNDISTORTS);
		struct observations seen = {0};
		struct camera_solution solution;
		struct camera_task task;
		double half;

		truth.focal *= 25;
		half = hypot(KNOWN_CAMERA_WIDTH, KNOWN_CAMERA_HEIGHT) / 2 * truth.pixel[0];
		truth.kappa1 = -0.015 / (half * half);
		task = known_camera_task(&truth);
		task.robust = true;
		known_camera_see_cloud(&seen, &truth, 1000, 0.05, &chance);
		for (int i = 0; i < seen.count; i += 20)
			for (int k = 0; k < 2; k++)
				seen.point[i].px[k] += chance_real(&chance, -60, 60);
		assert_int_equal(camera_calibrate(&seen, &task, &solution, NULL), 0);
		expect_below(solution.finding.rms_px, 1.1 * M_SQRT2 * 0.05, "run=%d", run);
		expect_that(known_camera_trusted(&solution), "run=%d", run);
		camera_solution_free(&solution);
		observations_free(&seen);
	}
}

/* One plane and a lens without distortion do not tell the axis. Its error must be as large as
 * assumed: by default, and by an option. The whole pose must
 * include that uncertainty. */
TEST("deviations of a held centre")
{
	static const char *const name[] = {"focal",	    "centre x",	     "centre y",
					   "rotation x",    "rotation y",    "rotation z",
					   "translation x", "translation y", "translation z"};
	struct chance chance = chance_begin("camera held");
	const int runs = (thorough() ? 2 : 1) * runs_of_test();

	for (int way = 0; way < 2; way++) {
		struct deviation_tally tally[9] = {{0}};

		for (int run = 0; run < runs; run++) {
			struct tsai_camera truth = known_camera(eyes[0], middle, 0, way & 1);
			struct observations seen = {0};
			struct camera_solution solution;
			const struct estimate *estimate = &solution.finding.estimate;
			struct camera_task task;
			double off, vector[3], want[9];

			task = known_camera_task(&truth);
			off = 0.025 * hypot(KNOWN_CAMERA_WIDTH, KNOWN_CAMERA_HEIGHT);
			if (way == 1)
				task.centre_deviation_px = off = 8;
			truth.centre_px[0] += off * chance_normal(&chance);
			truth.centre_px[1] += off * chance_normal(&chance);
			known_camera_see_board(&seen, &truth, 12, 9, 0.2, &chance);
			assert_int_equal(camera_calibrate(&seen, &task, &solution, NULL), 0);
			rotation_to_vector(truth.rotation, vector);
			want[0] = truth.focal;
			want[1] = truth.centre_px[0];
			want[2] = truth.height - truth.centre_px[1];
			for (int k = 0; k < 3; k++) {
				want[3 + k] = vector[k];
				want[6 + k] = truth.translation[k];
			}
			for (int k = 0; k < 9; k++) {
				const int at = estimate_find(estimate, name[k]);
				const double sigmas =
					fabs(estimate->parameter[at].value - want[k]) /
					estimate_deviation(estimate, at);

				tally[k].runs++;
				tally[k].one += sigmas < 1;
				tally[k].two += sigmas < 1.959964;
				tally[k].three += sigmas < 3;
			}
			camera_solution_free(&solution);
			observations_free(&seen);
		}
		for (int k = 0; k < 9; k++)
			assert_nearly_honest(&tally[k], 0.05);
	}
}

/* One plane does not tell s. Its error must be as large as assumed: by default, and by an option.
 */
TEST("deviations of a held aspect")
{
	struct chance chance = chance_begin("camera held aspect");
	const int runs = (thorough() ? 2 : 1) * runs_of_test();

	for (int way = 0; way < 2; way++) {
		struct deviation_tally tally[TALLIES] = {{0}};

		for (int run = 0; run < runs; run++) {
			struct tsai_camera truth = known_camera(eyes[1], middle, 0, run & 1);
			struct observations seen = {0};
			struct camera_solution solution;
			struct camera_task task = known_camera_task(&truth);

			task.centre_deviation_px = 0;
			if (way)
				task.aspect_deviation = 0.01;
			truth.aspect += (way ? 0.01 : CAMERA_ASPECT_DEVIATION) *
					chance_normal(&chance);
			known_camera_see_board(&seen, &truth, 12, 9, 0.2, &chance);
			assert_int_equal(camera_calibrate(&seen, &task, &solution, NULL), 0);
			expect_equal(solution.camera.aspect, 1, "way=%d, run=%d", way, run);
			/* a fixed aspect is uncertain all the same */
			solution.finding.estimate.parameter[MODEL_ASPECT].fixed = false;
			count_all(tally, &solution, &truth, "");
			camera_solution_free(&solution);
			observations_free(&seen);
		}
		for (int k = 0; k < TALLIES; k++) {
			if (getenv("INLAY_RUNS"))
				printf("# way %d, parameter %d: %d %d %d of %d\n", way, k,
				       tally[k].one, tally[k].two, tally[k].three, tally[k].runs);
			if (tally[k].runs)
				assert_nearly_honest(&tally[k], 0.05);
		}
	}
}

/* What is given is not estimated, neither from points in space nor from many boards. */
TEST("known aspect")
{
	struct chance chance = chance_begin("camera known aspect");

	for (int way = 0; way < 4; way++) {
		struct tsai_camera truth[5];
		struct observations seen = {0};
		struct camera_solution solution;
		struct camera_task task;

		for (int e = 0; e < 5; e++) {
			truth[e] = known_camera_roll(known_camera(eyes[e], middle, -0.08, way & 1),
						     0.6 * e);
			truth[e].aspect = 1.07;
			if (way / 2)
				known_camera_see_board(&seen, &truth[e], 9, 6, 0.2, &chance);
		}
		if (way / 2 == 0)
			known_camera_see_cloud(&seen, &truth[0], 60, 0.2, &chance);
		task = known_camera_task(&truth[0]);
		task.aspect_given = true;
		task.aspect = 1.07;
		assert_int_equal(camera_calibrate(&seen, &task, &solution, NULL), 0);
		expect_equal(solution.camera.aspect, 1.07, "way=%d", way);
		assert_true(solution.finding.estimate.parameter[MODEL_ASPECT].fixed);
		expect_below(fabs(solution.camera.focal / truth[0].focal - 1), 0.02, "way=%d", way);
		expect_that(known_camera_trusted(&solution), "way=%d", way);
		camera_solution_free(&solution);
		observations_free(&seen);
	}
}

/* Distance between drawn and true place of the object, at most, as a multiple of the reported
 * uncertainty. */
static double off_by(const struct camera_solution *solution, const struct camera_task *task,
		     const struct tsai_camera *truth)
{
	double most = 0;

	for (int k = 0; k < 7; k++) {
		double world[3], want[2], got[2];

		memcpy(world, task->object, sizeof(world));
		if (k)
			world[(k - 1) / 2] += k % 2 ? task->object_radius : -task->object_radius;
		if (tsai_project(truth, world, want))
			continue;
		assert_int_equal(tsai_project(&solution->camera, world, got), 0);
		most = fmax(most, hypot(want[0] - got[0], want[1] - got[1]));
	}
	assert_string_equal(solution->finding.figure[0].key, "object_error_px");
	return most / solution->finding.figure[0].value;
}

/* Few boards, seen by cameras whose pixels may not be square: a trusted result is right, and where
 * squareness is known enough results are trusted. */
TEST("few boards of squashed pixels")
{
	static const double aspects[] = {1, 1.005, 1.02, 0.95, 0.9};
	struct chance chance = chance_begin("camera squashed");
	const int runs = (thorough() ? 2 : 1) * runs_of_test();
	int trusted[2][4] = {{0}};

	for (int run = 0; run < runs; run++)
		for (int views = 1; views <= 3; views++) {
			struct tsai_camera truth[3];
			struct observations seen = {0};
			struct camera_task task;

			for (int v = 0; v < views; v++) {
				double at[3];

				chance_direction(&chance, 0.4, at);
				for (int k = 0; k < 3; k++)
					at[k] *= 0.6;
				truth[v] =
					known_camera_roll(known_camera(at, middle, -0.1, run & 1),
							  chance_real(&chance, -3, 3));
				truth[v].aspect = aspects[run % 5];
				known_camera_see_board(&seen, &truth[v], 9, 6, run % 2 ? 0.05 : 0.2,
						       &chance);
			}
			task = known_camera_task(&truth[0]);
			task.object_given = true;
			task.object_radius = task.object[2] = 0.06;
			for (int known = 0; known < 2; known++) {
				struct camera_solution solution;

				task.aspect_given = known;
				task.aspect = known ? truth[0].aspect : 1;
				task.aspect_deviation = known ? 0 : 0.05;
				assert_int_equal(camera_calibrate(&seen, &task, &solution, NULL),
						 0);
				if (solution.finding.verdict.trusted) {
					trusted[known][views]++;
					expect_below(off_by(&solution, &task, &truth[0]), 5,
						     "run=%d, views=%d, known=%d", run, views,
						     known);
				}
				camera_solution_free(&solution);
			}
			observations_free(&seen);
		}
	printf("# trusted of %d of one, two, three boards: %d %d %d, s known: %d %d %d\n", runs,
	       trusted[0][1], trusted[0][2], trusted[0][3], trusted[1][1], trusted[1][2],
	       trusted[1][3]);
	assert_true(trusted[0][2] && trusted[0][3] && trusted[1][1]);
	assert_true(trusted[1][3] > runs / 2);
}

/* The error of each point against the uncertainty that is reported for its place. */
TEST("uncertainty is honest")
{
	const double place[3] = {0.03, -0.02, 0.04};
	struct chance chance = chance_begin("camera uncertainty");
	const int runs = 4 * runs_of_test();
	double squares = 0, expected = 0;

	for (int run = 0; run < runs; run++) {
		const struct tsai_camera truth = known_camera(eyes[0], middle, -0.08, run & 1);
		struct observations seen = {0};
		struct camera_solution solution;
		struct camera_task task = known_camera_task_of_plane(&truth);
		double want[2], got[2];
		int figure = 0;

		memcpy(task.object, place, sizeof(place));
		task.object_given = true;
		known_camera_see_board(&seen, &truth, 12, 9, 0.3, &chance);
		assert_int_equal(camera_calibrate(&seen, &task, &solution, NULL), 0);
		assert_int_equal(tsai_project(&truth, place, want), 0);
		assert_int_equal(tsai_project(&solution.camera, place, got), 0);
		while (strcmp(solution.finding.figure[figure].key, "object_error_px"))
			figure++;
		squares += pow(want[0] - got[0], 2) + pow(want[1] - got[1], 2);
		expected += pow(solution.finding.figure[figure].value, 2);
		camera_solution_free(&solution);
		observations_free(&seen);
	}
	/* only the longest axis is expected: two axes together have between it and sqrt 2 of it */
	assert_true(squares > 0.85 * expected && squares < 2.2 * expected);
}
