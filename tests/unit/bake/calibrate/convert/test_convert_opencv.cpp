/* SPDX-License-Identifier: MIT */
/* Lenses through OpenCV's own reader, writer and projection, in both directions. */
#include <cmath>
#include <csetjmp>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

extern "C" {

#include "bake/calibrate/convert/convert.h"
#include "tests/support/own_folder.h"
#include "tests/support/test.h"
}

namespace
{

/* Largest difference of images of points at depth 1. */
constexpr double SAME_PX = 1e-9;

std::vector<cv::Point3d> points()
{
	std::vector<cv::Point3d> all;

	for (int y = -4; y <= 4; y++)
		for (int x = -5; x <= 5; x++)
			all.emplace_back(0.1 * x, 0.1 * y, 1);
	return all;
}

tsai_camera some_camera()
{
	tsai_camera camera = {};

	camera.width = 720;
	camera.height = 576;
	for (int k = 0; k < 9; k += 4)
		camera.rotation[k] = 1;
	camera.focal = 8.4;
	camera.kappa1 = -0.003;
	camera.kappa2 = 7e-5;
	camera.kappa3 = -1e-6;
	camera.tangential[0] = 2e-4;
	camera.tangential[1] = -3e-4;
	camera.centre_px[0] = 371.25;
	camera.centre_px[1] = 270.5;
	camera.pixel[0] = 0.0132;
	camera.pixel[1] = 0.0121;
	camera.aspect = 1.07;
	return camera;
}

/* Reads our file with OpenCV. */
void read_back(const char *path, cv::Mat &matrix, cv::Mat &distortion)
{
	cv::FileStorage file(path, cv::FileStorage::READ);

	assert_true(file.isOpened());
	file["camera_matrix"] >> matrix;
	file["distortion_coefficients"] >> distortion;
	assert_int_equal((int)file["image_width"], 720);
	assert_int_equal((int)file["image_height"], 576);
	assert_int_equal(matrix.type(), CV_64F);
	assert_int_equal(matrix.rows * matrix.cols, 9);
}

void write_ours(const lens &ours)
{
	FILE *file = std::fopen(own_folder_path("ours.yml"), "w");

	assert_non_null(file);
	lens_write_opencv(file, &ours, 0.25);
	assert_int_equal(std::fclose(file), 0);
}

TEST("camera read")
{
	const tsai_camera camera = some_camera();
	const std::vector<cv::Point3d> world = points();
	std::vector<cv::Point2d> seen;
	cv::Mat matrix, distortion;
	double error_px;
	lens ours;

	assert_int_equal(lens_of_tsai(&ours, &camera, 0, &error_px, nullptr), 0);
	write_ours(ours);
	read_back(own_folder_path("ours.yml"), matrix, distortion);
	cv::projectPoints(world, cv::Vec3d(0, 0, 0), cv::Vec3d(0, 0, 0), matrix, distortion, seen);
	for (size_t k = 0; k < world.size(); k++) {
		const double place[3] = {world[k].x, world[k].y, world[k].z};
		double px[2];

		assert_int_equal(tsai_project(&camera, place, px), 0);
		/* OpenCV's pixel centres are at whole numbers */
		assert_true(std::hypot(px[0] - 0.5 - seen[k].x, px[1] - 0.5 - seen[k].y) < SAME_PX);
	}
	assert_int_equal(std::remove(own_folder_path("ours.yml")), 0);
}

TEST("fisheye read")
{
	const std::vector<cv::Point3d> world = points();
	std::vector<cv::Point2d> seen;
	fisheye_settings settings = {};
	cv::Mat matrix, distortion;
	fisheye prepared;
	double error_px;
	lens ours;

	settings.focal_px[0] = 230;
	settings.focal_px[1] = 221;
	settings.centre_px[0] = 361;
	settings.centre_px[1] = 290;
	settings.field_deg = 80;
	settings.model = FISHEYE_POLYNOMIAL;
	settings.polynomial[0] = 0.03;
	settings.polynomial[1] = -0.01;
	settings.polynomial[3] = 0.0005;
	assert_int_equal(lens_of_fisheye(&ours, &settings, 720, 576, 0, &error_px, nullptr), 0);
	assert_int_equal(fisheye_prepare(&prepared, &settings, 720, 576, nullptr), 0);
	write_ours(ours);
	read_back(own_folder_path("ours.yml"), matrix, distortion);
	cv::fisheye::projectPoints(world, seen, cv::Vec3d(0, 0, 0), cv::Vec3d(0, 0, 0), matrix,
				   distortion);
	for (size_t k = 0; k < world.size(); k++) {
		const double place[3] = {world[k].x, world[k].y, world[k].z};
		double px[2];

		assert_true(fisheye_project(&prepared, place, px));
		assert_true(std::hypot(px[0] - 0.5 - seen[k].x, px[1] - 0.5 - seen[k].y) < SAME_PX);
	}
	assert_int_equal(std::remove(own_folder_path("ours.yml")), 0);
}

/* Writes as OpenCV's calibration program does, with many fields that inlay does not use, in single
 * and double precision. */
void write_theirs(const char *path, const cv::Mat &matrix, const cv::Mat &distortion)
{
	cv::FileStorage file(path, cv::FileStorage::WRITE);

	file << "calibration_time"
	     << "now: \"then\"";
	file << "image_width" << 720 << "image_height" << 576;
	file.writeComment("flags: none");
	file << "grid_points" << cv::Mat(points());
	file << "nested"
	     << "{"
	     << "camera_matrix" << 7 << "list"
	     << "[" << 1 << 2 << "]"
	     << "}";
	file << "camera_matrix" << matrix << "distortion_coefficients" << distortion;
	file << "avg_reprojection_error" << 0.3 << "names"
	     << "["
	     << "a"
	     << "b"
	     << "]";
}

TEST("written by opencv")
{
	for (int terms : {4, 5, 8, 14})
		for (int type : {CV_64F, CV_32F})
			for (int across : {0, 1}) {
				cv::Mat matrix = (cv::Mat_<double>(3, 3) << 536.07, 0, 342.37, 0,
						  536.02, 235.54, 0, 0, 1);
				cv::Mat distortion = cv::Mat::zeros(terms, 1, CV_64F);
				fault wrong = {};
				lens read = {};

				distortion.at<double>(0) = -0.25;
				distortion.at<double>(3) = 1e-5;
				if (across)
					distortion = distortion.t();
				matrix.convertTo(matrix, type);
				distortion.convertTo(distortion, type);
				write_theirs(own_folder_path("theirs.yml"), matrix, distortion);
				if (lens_read_foreign(&read, own_folder_path("theirs.yml"), NULL,
						      &wrong))
					fail_msg("%s", wrong.text);
				assert_int_equal(read.width, 720);
				assert_int_equal(read.fisheye, 0);
				assert_true(std::fabs(read.focal_px[0] - 536.07) < 1e-4);
				assert_true(std::fabs(read.centre_px[1] - 236.04) < 1e-4);
				assert_true(read.term[LENS_K1] == -0.25);
				assert_true(std::fabs(read.term[LENS_P2] - 1e-5) < 1e-10);
			}
	assert_int_equal(std::remove(own_folder_path("theirs.yml")), 0);
}

} // namespace

TEST_GROUP(own_folder_make, own_folder_remove);
