/* SPDX-License-Identifier: MIT */
/*
 * Lenses as OpenCV and ROS write them, and their way from and to ours.
 *
 * Their pinhole: with x, y in units of the focal length and r^2 = x^2 + y^2 before distortion,
 *     x' = x (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6)
 *            + 2 p1 x y + p2 (r^2 + 2 x^2),   y' likewise.
 * Of these Tsai's camera (hal/optics/tsai.h) that distorts has k1 = kappa1 f^2, exactly; the one
 * that undistorts is met by k1, k2, k3, or all six, fitted to it. Their fisheye is our polynomial
 * (hal/optics/fisheye_curve.h) exactly; lenses of other models are met by one fitted to them.
 * Their pixel centres are at whole numbers, ours at +0.5.
 */
#ifndef INLAY_BAKE_CALIBRATE_CONVERT_CONVERT_H
#define INLAY_BAKE_CALIBRATE_CONVERT_CONVERT_H

#include <stdbool.h>
#include <stdio.h>

#include "bake/calibrate/estimate/lens_ini.h"
#include "hal/base/fault.h"
#include "hal/optics/fisheye.h"
#include "hal/optics/tsai.h"

enum { LENS_K1, LENS_K2, LENS_P1, LENS_P2, LENS_K3, LENS_K4, LENS_K5, LENS_K6, LENS_TERMS };

struct lens {
	bool fisheye;
	int width, height;	 /* of the picture, px */
	double focal_px[2];	 /* horizontal and vertical */
	double centre_px[2];	 /* from the upper left corner, ours: pixel centres at +0.5 */
	double term[LENS_TERMS]; /* as OpenCV orders them; of a fisheye, k1..k4 come first */
};

/* ---- lenses ---- */

/* Where their pinhole has what is at straight without distortion, both in focal lengths from the
 * axis. */
void lens_bend(const struct lens *lens, const double straight[2], double bent[2]);

/*
 * All that is not the lens (where the camera is, its falloff) is left out. error_px: the largest
 * distance between the two anywhere in the picture; 0 when they are the same.
 * -EINVAL: what the camera says is out of range; -ERANGE: error_px is beyond tolerance_px.
 */
int lens_of_tsai(struct lens *lens, const struct tsai_camera *camera, double tolerance_px,
		 double *error_px, struct fault *fault);
int lens_of_fisheye(struct lens *lens, const struct fisheye_settings *settings, int width,
		    int height, double tolerance_px, double *error_px, struct fault *fault);

/*
 * A camera at the world's origin that looks along Z, with a sensor of 36 mm. Exact where k1 is the
 * only term; else kappa1 in the direction that comes nearer, f, centre and s are fitted to the
 * whole picture, and what a turn of the camera (turn_deg) makes up for is no error, because how it
 * is turned is not known here and found afterwards. Errors as above, and -EINVAL for a fisheye.
 */
int lens_to_tsai(const struct lens *lens, struct tsai_camera *camera, double tolerance_px,
		 double *error_px, double *turn_deg, struct fault *fault);
/* A lens on its back; its field is 90 degrees, or what the picture holds or the polynomial bears,
 * if that is less. -EINVAL for a pinhole. */
int lens_to_fisheye(const struct lens *lens, struct fisheye_settings *settings,
		    struct fault *fault);

/* ---- files ---- */

enum lens_file { LENS_FILE_INI, LENS_FILE_OPENCV, LENS_FILE_ROS };

extern const char *const lens_file_names[]; /* "ini", "opencv", "ros", NULL */

/*
 * Either of the two: camera_matrix, distortion_coefficients, image_width and image_height, and
 * distortion_model (ROS) or fisheye_model (OpenCV's own calibration program); anything else is
 * passed over. lens->width and height say what they are where the file does not; fisheye: it is one
 * where the file does not say. -ENOENT...; -EINVAL with file, line and what was expected.
 */
int lens_read_yaml(struct lens *lens, const char *path, struct fault *fault);

/* What is given in it; from: what it was made of, for a comment. */
void lens_write_ini(FILE *to, const struct lens_ini *ini, const char *from, double error_px,
		    double turn_deg);

/* error_px goes into a comment where it is not 0. */
void lens_write_opencv(FILE *to, const struct lens *lens, double error_px);
void lens_write_ros(FILE *to, const struct lens *lens, const char *name, double error_px);

#endif
