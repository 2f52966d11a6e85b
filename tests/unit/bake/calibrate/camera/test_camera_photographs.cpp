/* SPDX-License-Identifier: MIT */
/* Photographs of a board, from Debian's opencv-doc: the calibration fits at least as well as
 * OpenCV's own with the same distortion (its k1 is kappa1 f^2, its k2 kappa2 f^4 ...), from the
 * same corners. */
#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <vector>

#include <opencv2/calib3d.hpp>
#include <sys/stat.h>

/* cmocka's macros are words that C++ headers use. */
extern "C" {

#include "bake/calibrate/camera/camera.h"
#include "bake/calibrate/observe/boards.h"
#include "hal/image/image.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"
}

#define FOLDER "/usr/share/doc/opencv-doc/examples/data"

/* What the left camera's photographs show, which several tests use. */
static struct observations left_seen;

/* Finds the board in all photographs of one camera, or in each other one; there is no tenth. */
static void photographs_look(const char *side, bool all, struct observations *seen)
{
	struct fault fault = {""};
	struct board board;
	struct stat info;

	if (stat(FOLDER "/left01.jpg", &info)) {
		print_message(FOLDER "/left01.jpg is missing: opencv-doc\n");
		skip();
	}
	assert_int_equal(board_parse(&board, "9x6:25mm", &fault), 0);
	for (int k = 1; k <= 14; k += all ? 1 : 2) {
		struct image picture;
		char path[256];
		int err;

		snprintf(path, sizeof(path), FOLDER "/%s%02d.jpg", side, k);
		if (stat(path, &info))
			continue;
		assert_int_equal(image_read(path, &picture, &fault), 0);
		err = board_find(&board, &picture, path, seen, &fault);
		if (err)
			print_message("%s\n", fault.text);
		assert_int_equal(err, 0);
		image_free(&picture);
	}
	assert_int_equal(seen->views, all ? 13 : 7);
	assert_int_equal(seen->count, seen->views * 54);
}

static struct observations &left_photographs()
{
	if (!left_seen.views)
		photographs_look("left", thorough(), &left_seen);
	return left_seen;
}

static double opencv(const struct observations *seen, int radial, cv::Mat &matrix,
		     cv::Mat &distortion)
{
	const int held = (radial < 2 ? cv::CALIB_FIX_K2 : 0) | (radial < 3 ? cv::CALIB_FIX_K3 : 0) |
			 cv::CALIB_ZERO_TANGENT_DIST;

	std::vector<std::vector<cv::Point3f>> world(seen->views);
	std::vector<std::vector<cv::Point2f>> px(seen->views);
	std::vector<cv::Mat> rotations, translations;

	for (int i = 0; i < seen->count; i++) {
		const struct observation *p = &seen->point[i];

		world[p->view].emplace_back(p->world[0], p->world[1], p->world[2]);
		px[p->view].emplace_back(p->px[0], p->px[1]);
	}
	return cv::calibrateCamera(
		world, px, cv::Size(seen->width, seen->height), matrix, distortion, rotations,
		translations, held,
		cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 300, 1e-14));
}

/* The same minimum, but that OpenCV rounds points to float. */
static void same_as_opencv(const struct tsai_camera &camera, const cv::Mat &matrix,
			   const cv::Mat &distortion)
{
	const double fx = camera.focal * camera.aspect, fy = camera.focal;

	assert_true(std::fabs(fx / matrix.at<double>(0, 0) - 1) < 1e-3);
	assert_true(std::fabs(fy / matrix.at<double>(1, 1) - 1) < 1e-3);
	assert_true(std::fabs(camera.kappa1 * fy * fy - distortion.at<double>(0)) < 3e-3);
	assert_true(std::fabs(camera.kappa2 * std::pow(fy, 4) - distortion.at<double>(1)) < 3e-2);
	assert_true(std::fabs(camera.centre_px[0] - matrix.at<double>(0, 2)) < 1);
}

static void as_near_as_opencv(const char *side, const struct observations &seen)
{
	struct fault fault = {""};
	double least = INFINITY;

	for (int radial = 1; radial <= 3; radial++) {
		struct camera_task task = camera_task_default();
		struct camera_solution solution;
		cv::Mat matrix, distortion;
		double theirs;

		task.width = seen.width;
		task.height = seen.height;
		task.radial = radial;
		assert_int_equal(camera_calibrate(&seen, &task, &solution, &fault), 0);
		assert_true(solution.solved);
		theirs = opencv(&seen, radial, matrix, distortion);
		print_message("%s, %d: rms %.9f px, OpenCV's %.9f px; %s\n", side, radial,
			      solution.finding.rms_px, theirs, solution.finding.verdict.reason);
		assert_true(solution.finding.rms_px <= theirs * (1 + 1e-6));
		assert_true(solution.finding.rms_px > 0.9 * theirs);
		assert_true(solution.finding.rms_px < least);
		least = solution.finding.rms_px;
		same_as_opencv(solution.camera, matrix, distortion);
		camera_solution_free(&solution);
	}
}

TEST("no worse than opencv")
{
	struct observations right = {};

	as_near_as_opencv("left", left_photographs());
	if (!thorough())
		return;
	photographs_look("right", true, &right);
	as_near_as_opencv("right", right);
	observations_free(&right);
}

/* Tsai's own direction of the distortion models the same lens, and fits about as well. */
TEST("in both directions")
{
	const struct observations &seen = left_photographs();
	double rms[2];

	for (int way = 0; way < 2; way++) {
		struct camera_task task = camera_task_default();
		struct camera_solution solution;

		task.width = seen.width;
		task.height = seen.height;
		task.distortion = way;
		assert_int_equal(camera_calibrate(&seen, &task, &solution, NULL), 0);
		rms[way] = solution.finding.rms_px;
		assert_true((solution.camera.kappa1 < 0) == (way == TSAI_DISTORTS));
		assert_true(solution.finding.verdict.trusted);
		camera_solution_free(&solution);
	}
	print_message("distorts %.6f px, undistorts %.6f px\n", rms[0], rms[1]);
	assert_true(std::fabs(rms[0] - rms[1]) < 0.1);
}

/* With the lens from all photographs, one photograph alone tells where its board is. */
TEST("where is the board now")
{
	const struct observations &seen = left_photographs();
	struct observations one = {};
	struct camera_task task = camera_task_default();
	struct camera_solution all, pose;

	task.width = seen.width;
	task.height = seen.height;
	task.reference = 4;
	assert_int_equal(camera_calibrate(&seen, &task, &all, NULL), 0);
	assert_int_equal(observations_begin_view(&one, "alone"), 0);
	one.width = seen.width;
	one.height = seen.height;
	for (int i = seen.view[4].first; i < seen.view[4].first + seen.view[4].count; i++)
		assert_int_equal(observations_add(&one, seen.point[i].world, seen.point[i].px, "p"),
				 0);
	task = camera_task_default();
	task.intrinsics = &all.camera;
	assert_int_equal(camera_calibrate(&one, &task, &pose, NULL), 0);
	assert_true(pose.finding.verdict.trusted);
	for (int k = 0; k < 9; k++)
		assert_true(std::fabs(pose.camera.rotation[k] - all.camera.rotation[k]) < 1e-4);
	for (int k = 0; k < 3; k++) /* m */
		assert_true(std::fabs(pose.camera.translation[k] - all.camera.translation[k]) <
			    1e-4);
	camera_solution_free(&pose);
	camera_solution_free(&all);
	observations_free(&one);
}

static int forget(void **)
{
	observations_free(&left_seen);
	return 0;
}

/* Copies all views but one. */
static void leave_out(const struct observations *seen, int view, struct observations *rest)
{
	*rest = {};
	rest->width = seen->width;
	rest->height = seen->height;
	for (int v = 0; v < seen->views; v++) {
		const struct observed_view *from = &seen->view[v];

		if (v == view)
			continue;
		assert_int_equal(observations_begin_view(rest, from->name), 0);
		rest->view[rest->views - 1].number = from->number;
		for (int i = from->first; i < from->first + from->count; i++)
			assert_int_equal(observations_add(rest, seen->point[i].world,
							  seen->point[i].px, "p"),
					 0);
	}
}

/* A turn's vector of less than half a turn: leaving out a view may find the longer one. */
static void shorten(double turn[3])
{
	const double angle = std::hypot(turn[0], turn[1], turn[2]);

	for (int k = 0; k < 3; k++)
		turn[k] *= std::remainder(angle, 2 * M_PI) / angle;
}

/* Values of all unknowns, by name; NAN where a solution has none. */
static std::vector<double> values_of(const struct estimate &all, const struct estimate &from)
{
	std::vector<double> value(all.count, NAN);

	for (int k = 0; k < all.count; k++) {
		const int at = estimate_find(&from, all.parameter[k].name);

		if (at >= 0 && !from.parameter[at].fixed)
			value[k] = from.parameter[at].value;
	}
	for (int k = 0; k < all.count; k++)
		if (strstr(all.parameter[k].name, "rotation x") && !std::isnan(value[k]))
			shorten(&value[k]);
	return value;
}

/* Deviations that leaving out one view after the other shows (jackknife), of the solution's
 * unknowns; NAN where there are none. */
static std::vector<double> jackknife_of(const struct observations *seen,
					const struct camera_task *task, const struct estimate &all)
{
	std::vector<double> count(all.count), sum(all.count), squares(all.count);
	const std::vector<double> middle = values_of(all, all);

	for (int v = 0; v < seen->views; v++) {
		struct observations rest;
		struct camera_solution one;

		leave_out(seen, v, &rest);
		assert_int_equal(camera_calibrate(&rest, task, &one, NULL), 0);
		const std::vector<double> value = values_of(all, one.finding.estimate);
		for (int k = 0; k < all.count; k++)
			if (!std::isnan(value[k])) {
				count[k]++;
				sum[k] += value[k] - middle[k];
				squares[k] += std::pow(value[k] - middle[k], 2);
			}
		camera_solution_free(&one);
		observations_free(&rest);
	}
	for (int k = 0; k < all.count; k++) {
		const double mean = sum[k] / count[k];

		squares[k] = std::sqrt((count[k] - 1) * (squares[k] / count[k] - mean * mean));
	}
	return squares;
}

/* The same of left*.jpg, known beforehand, because it takes a minute to find. */
static const struct {
	const char *name;
	double deviation;
} jackknife_of_left[] = {{"focal", 0.941},   {"kappa1", 1.13e-8}, {"kappa2", 1.30e-13},
			 {"centre x", 1.64}, {"centre y", 1.27},  {"aspect", 3.65e-4}};

/*
 * Declared deviations are those of the jackknife within a factor of 1.5. A pose also has noise of
 * its own view, which leaving out others cannot show: it may be declared worse. A jackknife of 13
 * views is itself known to 1 / sqrt(2 * 12), a fifth; the largest of some 80 poses' numbers is then
 * 1.5 times too large by chance, so each may be declared at half of it.
 */
static void declared_as_leaving_out_views(const char *side)
{
	struct observations seen = {};
	struct camera_task task = camera_task_default();
	struct camera_solution all;
	const struct estimate *estimate = &all.finding.estimate;

	photographs_look(side, true, &seen);
	task.width = seen.width;
	task.height = seen.height;
	task.radial = 2; /* as many as are chosen */
	assert_int_equal(camera_calibrate(&seen, &task, &all, NULL), 0);
	assert_true(all.finding.verdict.trusted);
	std::vector<double> jackknife(estimate->count, NAN);
	if (thorough())
		jackknife = jackknife_of(&seen, &task, *estimate);
	else
		for (const auto &known : jackknife_of_left)
			jackknife[estimate_find(estimate, known.name)] = known.deviation;
	for (int k = 0; k < estimate->count; k++) {
		const double ratio = estimate_deviation(estimate, k) / jackknife[k];
		const char *name = estimate->parameter[k].name;
		const bool pose = strstr(name, "rotation") || strstr(name, "translation");

		if (std::isnan(jackknife[k]))
			continue;
		print_message("%s, %s: %.2f of the jackknife's %.3g\n", side, name, ratio,
			      jackknife[k]);
		assert_true(ratio > (pose ? 1 / 2.0 : 1 / 1.5) && ratio < (pose ? 5 : 1.5));
	}
	camera_solution_free(&all);
	observations_free(&seen);
}

TEST("deviations are by view")
{
	declared_as_leaving_out_views("left");
	if (thorough())
		declared_as_leaving_out_views("right");
}

/* Photographs of two cameras are no photographs of one, however well each fits. */
TEST("two cameras are doubted")
{
	struct observations seen[2] = {}, mixed = {};
	struct camera_task task = camera_task_default();
	struct camera_solution solution;

	photographs_look("left", true, &seen[0]);
	photographs_look("right", true, &seen[1]);
	task.width = mixed.width = seen[0].width;
	task.height = mixed.height = seen[0].height;
	for (int v = 0; v < seen[0].views; v++) {
		const struct observations *from = &seen[v % 2];
		const struct observed_view *view = &from->view[v];

		assert_int_equal(observations_begin_view(&mixed, view->name), 0);
		for (int i = view->first; i < view->first + view->count; i++)
			assert_int_equal(observations_add(&mixed, from->point[i].world,
							  from->point[i].px, "p"),
					 0);
	}
	assert_int_equal(camera_calibrate(&mixed, &task, &solution, NULL), 0);
	print_message("%s\n", solution.finding.verdict.reason);
	assert_false(solution.finding.verdict.trusted);
	camera_solution_free(&solution);
	observations_free(&mixed);
	observations_free(&seen[0]);
	observations_free(&seen[1]);
}

TEST_GROUP(NULL, forget);
