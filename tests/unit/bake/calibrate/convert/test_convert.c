/* SPDX-License-Identifier: MIT */
/* Lenses to and from the files of OpenCV and ROS: exact where possible, otherwise with the error
 * that is reported; whole files and damaged ones. test_convert_opencv checks what OpenCV makes of
 * them. */
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "bake/calibrate/convert/convert.h"
#include "tests/support/expect.h"
#include "tests/support/own_folder.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"

#define TOLERANCE_PX 0.1

/* ---- cameras ---- */

static struct tsai_camera some_camera(double kappa1, enum tsai_distortion distortion)
{
	return (struct tsai_camera){.width = 720,
				    .height = 576,
				    .rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1},
				    .focal = 8.4,
				    .kappa1 = kappa1,
				    .distortion = distortion,
				    .centre_px = {371.25, 270.5},
				    .pixel = {0.0132, 0.0121},
				    .aspect = 1.07};
}

/* Largest distance between the images that two cameras at the same place have of a point of the
 * first one's picture. */
static double farthest(const struct tsai_camera *a, const struct tsai_camera *b)
{
	double worst = 0;

	for (int k = 0; k < 21 * 17; k++) {
		const double px[2] = {k % 21 * 36.0, k / 21 * 36.0};
		double origin[3], dir[3], again[2];

		if (tsai_ray(a, px, origin, dir))
			continue;
		assert_int_equal(tsai_project(b, dir, again), 0);
		worst = fmax(worst, hypot(px[0] - again[0], px[1] - again[1]));
	}
	return worst;
}

static void write_file(const char *name, const char *text)
{
	FILE *file = fopen(own_folder_path(name), "w");

	assert_non_null(file);
	fputs(text, file);
	assert_int_equal(fclose(file), 0);
}

/* Writes a lens to a file of either kind and reads it back. */
static struct lens again(const struct lens *lens, bool ros, double error_px)
{
	struct fault fault = {.text = ""};
	struct lens read = {.width = 0};
	FILE *file = fopen(own_folder_path("lens.yaml"), "w");

	assert_non_null(file);
	if (ros)
		lens_write_ros(file, lens, "kiosk", error_px);
	else
		lens_write_opencv(file, lens, error_px);
	assert_int_equal(fclose(file), 0);
	if (lens_read_foreign(&read, own_folder_path("lens.yaml"), NULL, &fault))
		fail_msg("%s", fault.text);
	assert_int_equal(remove(own_folder_path("lens.yaml")), 0);
	return read;
}

TEST("distorts")
{
	static const double kappa1[] = {0, -0.004, 0.002};

	for (int k = 0; k < 12; k++) {
		struct tsai_camera camera = some_camera(kappa1[k % 3], TSAI_DISTORTS);
		struct tsai_camera back;
		struct lens lens, read;
		double error_px = -1;

		if (k >= 6) {
			camera.kappa2 = 7e-5;
			camera.kappa3 = k >= 9 ? 1e-6 : 0;
			camera.tangential[0] = 1e-4;
			camera.tangential[1] = k >= 9 ? -2e-4 : 0;
		}
		assert_int_equal(lens_of_tsai(&lens, &camera, 0, &error_px, NULL), 0);
		expect_equal(error_px, 0, "k=%d", k);
		read = again(&lens, k % 6 >= 3, error_px);
		assert_memory_equal(&read, &lens, sizeof(lens));
		assert_int_equal(lens_to_tsai(&read, &back, 0, &error_px, NULL), 0);
		expect_equal(error_px, 0, "k=%d", k);
		expect_below(farthest(&camera, &back), 1e-9, "k=%d", k);
	}
}

TEST("undistorts")
{
	static const double kappa1[] = {0.004, -0.002, 0.012};

	for (int k = 0; k < 6; k += thorough() ? 1 : 5) {
		struct tsai_camera camera = some_camera(kappa1[k % 3], TSAI_UNDISTORTS);
		struct tsai_camera back;
		struct fault fault = {.text = ""};
		struct lens lens, read;
		double out_px, in_px;

		if (k >= 3) {
			camera.kappa2 = 3e-5;
			camera.tangential[0] = 2e-6;
		}
		if (lens_of_tsai(&lens, &camera, TOLERANCE_PX, &out_px, &fault))
			fail_msg("%s", fault.text);
		read = again(&lens, false, out_px);
		assert_int_equal(lens_to_tsai(&read, &back, TOLERANCE_PX, &in_px, NULL), 0);
		print_message("kappa1 %g that undistorts: %.2g px out, %.2g px in\n", camera.kappa1,
			      out_px, in_px);
		/* three terms are ours in the other direction; six are fitted */
		expect_equal(in_px == 0, lens.term[LENS_K4] == 0, "k=%d", k);
		/* the reported errors hold */
		expect_below(farthest(&camera, &back), out_px + in_px + 1e-9, "k=%d", k);
		expect_equal(lens_of_tsai(&lens, &camera, out_px / 2, &out_px, &fault), -ERANGE,
			     "k=%d", k);
		assert_non_null(strstr(fault.text, "expected at most"));
	}
}

/* Terms that Tsai's camera lacks: the error is that of the resulting camera. */
TEST("terms")
{
	static const struct {
		double term[LENS_TERMS];
		double least, most; /* expected error, px */
	} cases[] = {
		{{-0.2, 0, 0, 0, 0, 0, 0, 0}, 0, 0},
		{{-0.2, 0.001, 0, 0, 0, 0, 0, 0}, 0, 0},
		{{-0.28, 0.05, 0.001, -0.0006, 0.04, 0, 0, 0}, 0, 0},
		{{0, 0, 0.01, 0, 0, 0, 0, 0}, 0, 0},
		{{0.1, 0, 0, 0, 0, 0.2, 0, 0}, 1e-6, 0.01},
		{{-0.1, 0.02, 0.001, -0.0006, 0, 0.1, 0, 0}, 1e-6, 0.1},
	};

	for (size_t k = 0; k < sizeof(cases) / sizeof(*cases); k++) {
		struct lens lens = {.width = 640,
				    .height = 480,
				    .focal_px = {536, 534},
				    .centre_px = {342.7, 235.9}};
		struct tsai_camera camera;
		double error_px;

		memcpy(lens.term, cases[k].term, sizeof(lens.term));
		assert_int_equal(lens_to_tsai(&lens, &camera, 1e6, &error_px, NULL), 0);
		print_message("case %zu: %.3g px\n", k, error_px);
		expect_that(error_px >= cases[k].least && error_px <= cases[k].most, "k=%zu", k);
		if (error_px > 0)
			expect_equal(lens_to_tsai(&lens, &camera, 0.9 * error_px, &error_px, NULL),
				     -ERANGE, "k=%zu", k);
	}
}

/* Terms that fold over inside of the picture are no lens: two points would be seen at one place. */
TEST("folds")
{
	struct lens lens = {.width = 640,
			    .height = 480,
			    .focal_px = {536, 534},
			    .centre_px = {342.7, 235.9},
			    .term = {-0.3, -0.4}};
	struct tsai_camera camera;
	struct fault fault = {.text = ""};
	double error_px;

	assert_int_equal(lens_to_tsai(&lens, &camera, 1e6, &error_px, &fault), -EINVAL);
	assert_non_null(strstr(fault.text, "fold the picture over"));
}

/* ---- fisheyes ---- */

TEST("fisheyes")
{
	for (int model = 0; model < FISHEYE_MODEL_COUNT; model++) {
		const struct fisheye_settings settings = {
			.focal_px = {230, 228},
			.centre_px = {361, 290},
			.field_deg = 85,
			.model = model,
			.polynomial = {0.02, -0.01, 0.001, 0},
		};
		const bool exact = model == FISHEYE_EQUIDISTANT || model == FISHEYE_POLYNOMIAL;
		struct fisheye_settings back;
		struct fisheye ours, theirs;
		struct lens lens, read;
		double error_px, worst = 0;

		assert_int_equal(lens_of_fisheye(&lens, &settings, 720, 576, 0.5, &error_px, NULL),
				 0);
		expect_equal(exact, (error_px == 0), "model=%d", model);
		read = again(&lens, model % 2, error_px);
		assert_memory_equal(&read, &lens, sizeof(lens));
		assert_int_equal(lens_to_fisheye(&read, &back, NULL), 0);
		assert_int_equal(fisheye_prepare(&ours, &settings, 720, 576, NULL), 0);
		assert_int_equal(fisheye_prepare(&theirs, &back, 720, 576, NULL), 0);
		for (int k = 0; k <= 85; k++) {
			const double dir[3] = {sin(k * M_PI / 180) * cos(k),
					       sin(k * M_PI / 180) * sin(k), cos(k * M_PI / 180)};
			double a[2], b[2];

			if (!fisheye_project(&ours, dir, a) || !fisheye_project(&theirs, dir, b))
				continue;
			worst = fmax(worst, hypot(a[0] - b[0], a[1] - b[1]));
		}
		print_message("%s: %.2g px\n", fisheye_model_names[model], error_px);
		expect_at_most(worst, error_px + 1e-9, "model=%d", model);
		if (!exact)
			expect_equal(lens_of_fisheye(&lens, &settings, 720, 576, error_px / 2,
						     &error_px, NULL),
				     -ERANGE, "model=%d", model);
	}
}

TEST("fields")
{
	struct lens lens = {.fisheye = true,
			    .width = 640,
			    .height = 480,
			    .focal_px = {600, 600},
			    .centre_px = {320, 240}};
	struct fisheye_settings settings;
	struct tsai_camera camera;
	double error_px;

	/* the corner of the picture is at 400 / 600 rad */
	assert_int_equal(lens_to_fisheye(&lens, &settings, NULL), 0);
	assert_true(fabs(settings.field_deg - 400 / 600.0 * 180 / M_PI) < 1e-9);
	assert_int_equal(settings.model, FISHEYE_EQUIDISTANT);
	/* t - 2/3 t^3 turns back at 1 / sqrt(2) rad */
	lens.term[0] = -2.0 / 3;
	lens.focal_px[0] = lens.focal_px[1] = 150;
	assert_int_equal(lens_to_fisheye(&lens, &settings, NULL), 0);
	assert_true(settings.field_deg < sqrt(0.5) * 180 / M_PI && settings.field_deg > 40);
	assert_int_equal(lens_to_tsai(&lens, &camera, 1, &error_px, NULL), -EINVAL);
	lens.fisheye = false;
	assert_int_equal(lens_to_fisheye(&lens, &settings, NULL), -EINVAL);
}

/* ---- files ---- */

#define OPENCV_HEAD "%YAML:1.0\n---\n"
#define OPENCV_CAMERA                                                                              \
	"camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 536.07, "    \
	"0.,\n"                                                                                    \
	"       342.37, 0., 536.02, 235.54, 0., 0., 1. ]\n"
#define OPENCV_DISTORTION                                                                          \
	"distortion_coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n"             \
	"   data: [ -2.6637260909660682e-01, -3.8588898922304653e-02,\n"                           \
	"       1.7831947042852964e-03, -2.8122100441115472e-04,\n       2.3839153080878486e-01 "  \
	"]\n"
#define SIZE "image_width: 640\nimage_height: 480\n"

TEST("files")
{
	/* as the calibration programs of OpenCV and of ROS write it */
	static const char opencv[] = OPENCV_HEAD
		"calibration_time: \"Fri 20 Nov 2026 18:00:00\"\n" SIZE
		"board_width: 9\nflags: 0\n# flags: none\n" OPENCV_CAMERA OPENCV_DISTORTION
		"avg_reprojection_error: 1.9e-01\nper_view_reprojection_errors: !!opencv-matrix\n"
		"   rows: 2\n   cols: 1\n   dt: f\n   data: [ 1.5e-01,\n       1.4e-01 ]\n"
		"image_points: []\nlist:\n- 1\n-\n   a: 2\n...\n";
	static const char ros[] =
		"image_width: 640\r\nimage_height: 480\r\ncamera_name: narrow_stereo\r\n"
		"camera_matrix:\r\n  rows: 3\r\n  cols: 3\r\n"
		"  data: [536.07, 0, 342.37, 0, 536.02, 235.54, 0, 0, 1]\r\n"
		"distortion_model: plumb_bob  # five of them\r\ndistortion_coefficients:\r\n"
		"  rows: 1\r\n  cols: 5\r\n"
		"  data: [-2.6637260909660682e-01, -3.8588898922304653e-02, 1.7831947042852964e-03, -2.8122100441115472e-04, 2.3839153080878486e-01]\r\n"
		"rectification_matrix:\r\n  rows: 3\r\n  cols: 3\r\n"
		"  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\r\nprojection_matrix:\r\n  rows: 3\r\n"
		"  cols: 4\r\n  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]\r\n";
	struct lens a = {.width = 0}, b = {.width = 0};
	struct fault fault = {.text = ""};

	write_file("opencv.yml", opencv);
	write_file("ros.yaml", ros);
	if (lens_read_foreign(&a, own_folder_path("opencv.yml"), NULL, &fault) ||
	    lens_read_foreign(&b, own_folder_path("ros.yaml"), NULL, &fault))
		fail_msg("%s", fault.text);
	assert_memory_equal(&a, &b, sizeof(a));
	assert_true(a.focal_px[0] == 536.07 && a.focal_px[1] == 536.02);
	assert_true(a.centre_px[0] == 342.37 + 0.5 && a.centre_px[1] == 235.54 + 0.5);
	assert_true(a.term[LENS_K3] == 2.3839153080878486e-01 && a.term[LENS_K4] == 0);
	assert_int_equal(remove(own_folder_path("opencv.yml")), 0);
	assert_int_equal(remove(own_folder_path("ros.yaml")), 0);
}

/* The same pinhole camera as everyone writes it. */
#define ROS_1                                                                                      \
	"header: \n  seq: 7\n  stamp: \n    secs: 3\n    nsecs: 0\n  frame_id: \"eye\"\n"          \
	"height: 480\nwidth: 640\ndistortion_model: \"plumb_bob\"\n"                               \
	"D: [-0.25, 0.0625, 0.001, -0.002, 0.0]\n"                                                 \
	"K: [536.0, 0.0, 342.0, 0.0, 535.0, 235.0, 0.0, 0.0, 1.0]\n"                               \
	"R: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]\n"
#define ROS_1_END                                                                                  \
	"P: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]\nbinning_x: 0\nbinning_y: 0\nroi: \n"             \
	"  x_offset: 0\n  y_offset: 0\n  height: 0\n  width: 0\n  do_rectify: False\n"
#define KALIBR_LENS                                                                                \
	"  T_cam_imu:\n  - [0.01, -0.9, 0.2, 0.0]\n  - [0.9, 0.01, 0.1, 0.0]\n"                    \
	"  - [0.0, 0.0, 0.0, 1.0]\n  cam_overlaps: [1]\n  camera_model: pinhole\n"                 \
	"  distortion_coeffs: [-0.25, 0.0625, 0.001, -0.002]\n  distortion_model: radtan\n"        \
	"  intrinsics: [536.0, 535.0, 342.0, 235.0]\n  resolution: [640, 480]\n"                   \
	"  rostopic: /cam0/image_raw\n  timeshift_cam_imu: 0.001\n"
#define KALIBR "cam0:\n" KALIBR_LENS
#define KALIBR_NAMED "left:\n" KALIBR_LENS
#define KALIBR_BOTH                                                                                \
	KALIBR "cam1:\n  camera_model: pinhole\n  intrinsics:\n  - 300.0\n  - 301.0\n  - 320.0\n"  \
	       "  - 240.0\n  distortion_model: equidistant\n"                                      \
	       "  distortion_coeffs: [0.003, -0.001, 0.0, 0.0]\n  resolution: [640, 480]\n"

static void assert_reads(const char *text, const char *camera, const struct lens *expected)
{
	struct fault fault = {.text = ""};
	struct lens read = {.width = 0};

	write_file("their.yaml", text);
	if (lens_read_foreign(&read, own_folder_path("their.yaml"), camera, &fault))
		fail_msg("%s, of\n%s", fault.text, text);
	assert_memory_equal(&read, expected, sizeof(read));
	assert_int_equal(remove(own_folder_path("their.yaml")), 0);
}

TEST("dialects")
{
	static const char ros_2[] =
		"header:\n  stamp:\n    sec: 3\n    nanosec: 0\n  frame_id: eye\nheight: 480\n"
		"width: 640\ndistortion_model: plumb_bob\nd:\n- -0.25\n- 0.0625\n- 0.001\n"
		"- -0.002\n- 0.0\nk:\n- 536.0\n- 0.0\n- 342.0\n- 0.0\n- 535.0\n- 235.0\n- 0.0\n"
		"- 0.0\n- 1.0\nr:\n- 1.0\nbinning_x: 0\nroi:\n  x_offset: 0\n  width: 0\n---\n"
		"height: 1\nk:\n- 1\n---\n";
	static const char stored[] =
		"%YAML:1.0\n---\nimage_size: [ 640, 480 ]\ncameraMatrix: !!opencv-matrix\n"
		"   rows: 3\n   cols: 3\n   dt: d\n"
		"   data: [ 536., 0., 342., 0., 535., 235., 0., 0., 1. ]\n"
		"distCoeffs: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n"
		"   data: [ -0.25, 0.0625, 0.001, -0.002, 0. ]\n";
	static const char melodic[] =
		"image_width: 640\nimage_height: 480\ncamera_name: narrow\ncamera_matrix:\n"
		"  rows: 3\n  cols: 3\n  data: [300, 0, 320, 0, 301, 240, 0, 0, 1]\n"
		"camera_model: fisheye\ndistortion_coefficients:\n  rows: 1\n  cols: 4\n"
		"  data: [0.003, -0.001, 0, 0]\n";
	/* on one line, and as JSON */
	static const char flow[] =
		"{image_width: 640, image_height: 480, camera_name: 'a, b', distortion_model: plumb_bob,\n"
		" camera_matrix: {rows: 3, cols: 3, data: [536, 0, 342, 0, 535, 235, # of K\n"
		" 0, 0, 1]}, other: {a: [{b: 1}, 2], x_offset: 3}, t_offset: 1, roi: {x_offset: 0}, distortion_coefficients: {rows: 1, cols: 5, data: [-0.25, 0.0625, 0.001, -0.002, 0]}}\n";
	static const char json[] =
		"{\"camera_matrix\": [[536.0, 0.0, 342.0], [0.0, 535.0, 235.0],\n"
		" [0.0, 0.0, 1.0]], \"dist_coeff\": [[-0.25, 0.0625, 0.001, -0.002, 0.0]], \"image_size\": [640, 480]}\n";
	static const char items[] = SIZE
		"camera_matrix:\n- - 536.0\n  - 0.0\n  - 342.0\n- - 0.0\n  - 535.0\n  - 235.0\n"
		"- - 0.0\n  - 0.0\n  - 1.0\ndist_coeff:\n- - -0.25\n  - 0.0625\n  - 0.001\n"
		"  - -0.002\n  - 0.0\n";
	const struct lens pinhole = {.width = 640,
				     .height = 480,
				     .focal_px = {536, 535},
				     .centre_px = {342.5, 235.5},
				     .term = {-0.25, 0.0625, 0.001, -0.002}};
	const struct lens fisheye = {.fisheye = true,
				     .width = 640,
				     .height = 480,
				     .focal_px = {300, 301},
				     .centre_px = {320.5, 240.5},
				     .term = {0.003, -0.001}};

	assert_reads(ROS_1 ROS_1_END "---\n" ROS_1, NULL, &pinhole);
	assert_reads(ros_2, NULL, &pinhole);
	assert_reads(stored, NULL, &pinhole);
	assert_reads(KALIBR, NULL, &pinhole);
	assert_reads(KALIBR_BOTH, "cam0", &pinhole);
	assert_reads(KALIBR_BOTH, "cam1", &fisheye);
	assert_reads(KALIBR_NAMED, NULL, &pinhole);
	assert_reads("header:\n  frame_id: left\n" KALIBR_NAMED KALIBR, "left", &pinhole);
	assert_reads(
		"/camera:\n  image_width: 640\n  image_height: 480\n  camera_model: plumb_bob\n"
		"  K: [536.0, 0, 342.0, 0, 535.0, 235.0, 0, 0, 1]\n"
		"  D: [-0.25, 0.0625, 0.001, -0.002]\n",
		NULL, &pinhole);
	assert_reads(melodic, NULL, &fisheye);
	assert_reads(flow, NULL, &pinhole);
	assert_reads(json, NULL, &pinhole);
	assert_reads(items, NULL, &pinhole);
}

TEST("damaged")
{
	static const struct {
		const char *text, *fault; /* fault: the message behind the file's name */
	} cases[] = {
		{"", ": has no camera_matrix of OpenCV, K of ROS or intrinsics of Kalibr"},
		{"Camera.fx: 500.0\nCamera.width: 640\n",
		 ": has no camera_matrix of OpenCV, K of ROS or intrinsics of Kalibr"},
		{SIZE, ": has no camera_matrix of OpenCV, K of ROS or intrinsics of Kalibr"},
		{"intrinsics: [1, 2, 3, 4]\n",
		 ": has no image_width and image_height, expected them here or by --size"},
		{SIZE OPENCV_CAMERA, ": has no distortion_coefficients"},
		{"\x89PNG\r\n",
		 ":1: invalid leading UTF-8 octet, expected YAML, as OpenCV, ROS and Kalibr write lenses"},
		{OPENCV_CAMERA "image_width: wide\n",
		 ":7: image_width: expected a whole number from 1 to 32768"},
		{OPENCV_CAMERA "image_width: 0\n",
		 ":7: image_width: expected a whole number from 1 to 32768"},
		{SIZE "distortion_model: omni\n" OPENCV_CAMERA OPENCV_DISTORTION,
		 ":3: distortion_model: omni, expected plumb_bob, radtan, rational_polynomial, equidistant or fisheye"},
		{SIZE "distortion_model: equidistant\n" OPENCV_CAMERA OPENCV_DISTORTION,
		 ":10: distortion_coefficients: 5 x 1 of them, expected one row of 4"},
		{SIZE "camera_matrix:\n  rows: 3\n  cols: 3\n  data: [ 1, 2,\n",
		 ":7: did not find expected node content, expected YAML, as OpenCV, ROS and Kalibr write lenses"},
		{SIZE "camera_matrix:\n  rows: 3\n  cols: 3\n  data: [ 1, two ]\n",
		 ":6: camera_matrix: expected finite numbers"},
		{SIZE "camera_matrix:\n  rows: 3\n  cols: 3\n  data: [ 1, 0x10 ]\n",
		 ":6: camera_matrix: expected finite numbers"},
		{SIZE "camera_matrix:\n  rows: 3\n  cols: 3\n  data: [ 1, nan ]\n",
		 ":6: camera_matrix: expected finite numbers"},
		{SIZE "camera_matrix:\n  rows: 3\n  cols: 3\n  data: [ 1, 2 ]\n",
		 ":3: camera_matrix: has 3 rows, 3 columns and 2 numbers, expected as many as rows times columns"},
		{SIZE "camera_matrix:\n  rows: 3\n  cols: 3\n  data:\n  - 1\n",
		 ":3: camera_matrix: has 3 rows, 3 columns and 1 numbers, expected as many as rows times columns"},
		{SIZE "camera_matrix: {rows: 3}\n",
		 ":3: camera_matrix: has 3 rows, 0 columns and 0 numbers, expected as many as rows times columns"},
		{"{image_width: 640, image_height: 480,\n",
		 ":2: did not find expected node content, expected YAML, as OpenCV, ROS and Kalibr write lenses"},
		{"{camera_matrix: [[1, 2}",
		 ":1: did not find expected ',' or ']', expected YAML, as OpenCV, ROS and Kalibr write lenses"},
		{"{a: {a: 1",
		 ":2: did not find expected ',' or '}', expected YAML, as OpenCV, ROS and Kalibr write lenses"},
		{ROS_1 "roi: {x_offset: 100, y_offset: 50, height: 240, width: 320}\n",
		 ":13: the picture is binned or cut out (x_offset), but K is of the whole one: expected a message of the whole picture"},
		{SIZE "K: [5, 0, 3, 0, 5, 3, 0, 0, 1]\nD:\n  rows: 4\n  cols: 1\n"
		      "  data: [ 1, 0, 0, 0 ]\n",
		 ":4: D: 4 of them are k1 k2 p1 p2 of a pinhole camera or k1 to k4 of a fisheye, and nothing says which: expected --fisheye, or a line distortion_model: plumb_bob"},
		{SIZE OPENCV_CAMERA "xi: 1.2\n",
		 ":9: xi: expected a pinhole camera or a fisheye, not an omnidirectional camera"},
		{SIZE "camera_matrix:\n  rows: 1\n  cols: 1\n"
		      "  data: [ 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0 ]\n",
		 ":6: camera_matrix: expected fewer numbers"},
		{SIZE "camera_matrix:\n  rows: 3\n  cols: 3\n"
		      "  data: [ 5, 1, 3, 0, 5, 3, 0, 0, 1 ]\n",
		 ":3: camera_matrix: a skew of 1, expected 0: rows and columns of pixels are at right angles here"},
		{SIZE "camera_matrix:\n  rows: 3\n  cols: 3\n"
		      "  data: [ -5, 0, 3, 0, 5, 3, 0, 0, 1 ]\n",
		 ":3: camera_matrix: expected fx 0 cx, 0 fy cy, 0 0 1 with fx and fy above 0"},
		{SIZE OPENCV_CAMERA OPENCV_CAMERA, ":9: camera_matrix: expected to be there once"},
		{SIZE OPENCV_CAMERA "distortion_coefficients:\n  rows: 9\n  cols: 1\n"
				    "  data: [ 1, 0, 0, 0, 0, 0, 0, 0, 0.5 ]\n",
		 ":9: distortion_coefficients: number 9 is 0.5, expected 0: neither thin prisms nor tilted sensors are known here"},
		{KALIBR_BOTH,
		 ":14: holds several cameras, cam0 and cam1: expected one of them by --camera"},
		{"cam0:\n  camera_model: ds\n  intrinsics: [1, 2, 3, 4, 5, 6]\n"
		 "  distortion_model: none\n  resolution: [640, 480]\n",
		 ":2: camera_model: ds, expected pinhole"},
		{"cam0:\n  camera_model: pinhole\n  intrinsics: [1, 2, 3, 4]\n"
		 "  distortion_model: fov\n  distortion_coeffs: [0.9]\n  resolution: [640, 480]\n",
		 ":4: distortion_model: fov, expected plumb_bob, radtan, rational_polynomial, equidistant or fisheye"},
		{ROS_1 "binning_x: 2\n",
		 ":13: the picture is binned or cut out (binning_x), but K is of the whole one: expected a message of the whole picture"},
	};
	struct fault fault;

	for (size_t k = 0; k < sizeof(cases) / sizeof(*cases); k++) {
		char expected[PATH_MAX + FAULT_TEXT_MAX];
		struct lens lens = {.width = 0};

		write_file("bad.yml", cases[k].text);
		snprintf(expected, sizeof(expected), "%s%s", own_folder_path("bad.yml"),
			 cases[k].fault);
		expect_equal(lens_read_foreign(&lens, own_folder_path("bad.yml"), NULL, &fault),
			     -EINVAL, "k=%zu", k);
		assert_string_equal(fault.text, expected);
	}
	assert_int_equal(remove(own_folder_path("bad.yml")), 0);
	assert_int_equal(lens_read_foreign(&(struct lens){.width = 0}, own_folder_path("bad.yml"),
					   NULL, &fault),
			 -ENOENT);
}

/* A file that is cut anywhere is refused or, when only the end behind its last number is missing,
 * read. */
TEST("truncated")
{
	static const char whole[] = OPENCV_HEAD SIZE OPENCV_CAMERA OPENCV_DISTORTION;

	for (size_t bytes = 0; bytes < sizeof(whole) - 3; bytes++) {
		struct lens lens = {.width = 0};
		char part[sizeof(whole)];

		memcpy(part, whole, bytes);
		part[bytes] = '\0';
		write_file("cut.yml", part);
		expect_equal(lens_read_foreign(&lens, own_folder_path("cut.yml"), NULL, NULL),
			     -EINVAL, "bytes=%zu", bytes);
	}
	assert_int_equal(remove(own_folder_path("cut.yml")), 0);
}

TEST("ini")
{
	struct lens_ini ini = {.camera_given = true,
			       .camera = some_camera(-0.004, TSAI_UNDISTORTS)};
	struct lens_ini read;
	struct fault fault = {.text = ""};
	FILE *file = fopen(own_folder_path("camera.ini"), "w");

	assert_non_null(file);
	lens_write_ini(file, &ini, "a test", 0.01);
	assert_int_equal(fclose(file), 0);
	if (lens_read_ini(&read, own_folder_path("camera.ini"), &fault))
		fail_msg("%s", fault.text);
	assert_memory_equal(&read.camera, &ini.camera, sizeof(ini.camera));
	write_file("camera.ini", "[fisheye]\n[camera]\nwidth = 1\n");
	assert_int_equal(lens_read_ini(&read, own_folder_path("camera.ini"), &fault), -EINVAL);
	write_file("camera.ini", "");
	assert_int_equal(lens_read_ini(&read, own_folder_path("camera.ini"), &fault), -EINVAL);
	assert_int_equal(remove(own_folder_path("camera.ini")), 0);
}

TEST_GROUP(own_folder_make, own_folder_remove);
