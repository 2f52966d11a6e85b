/* SPDX-License-Identifier: MIT */
/*
 * Lenses as OpenCV, ROS and Kalibr write them, and their conversion from and to ours.
 *
 * Their pinhole camera, with x, y in units of the focal length before distortion and r^2 = x^2 +
 * y^2:
 *     x' = x (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6)
 *            + 2 p1 x y + p2 (r^2 + 2 x^2),   y' likewise
 * Tsai's camera (hal/optics/tsai.h) in direction `distorts` is one without k4 to k6, exactly: k1 =
 * kappa1 f^2, k2 = kappa2 f^4, k3 = kappa3 f^6, (p2, p1) = q f. In direction `undistorts` it is
 * approximated by k1, k2, k3, or all six, and p1, p2. Their fisheye is our
 * polynomial model (hal/optics/fisheye.h) exactly; other models are approximated by it. Their
 * pixel centres are at whole numbers, ours at +0.5.
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
	int width, height;  /* size of the picture, px */
	double focal_px[2]; /* horizontal and vertical */
	/* from the upper left corner, in our coordinates: pixel centres at +0.5 */
	double centre_px[2];
	double term[LENS_TERMS]; /* in OpenCV's order; a fisheye's k1..k4 come first */
};

/* ---- lenses ---- */

/* Distorts a point as their pinhole camera does; both in focal lengths from the axis. */
void lens_bend(const struct lens *lens, const double straight[2], double bent[2]);

/*
 * Convert our lens to theirs, without what is not the lens (pose, falloff). error_px: the largest
 * distance between the two anywhere in the picture; 0 if the conversion is exact. -EINVAL: the
 * camera's values are out of range; -ERANGE: error_px is above tolerance_px.
 */
int lens_of_tsai(struct lens *lens, const struct tsai_camera *camera, double tolerance_px,
		 double *error_px, struct fault *fault);
int lens_of_fisheye(struct lens *lens, const struct fisheye_settings *settings, int width,
		    int height, double tolerance_px, double *error_px, struct fault *fault);

/*
 * Converts to a camera at the world's origin that looks along Z, with a sensor 36 mm wide. Exact
 * if k4 to k6 are 0; else f and the kappas are fitted to the radii up to the farthest corner.
 * Errors as above, and -EINVAL for a fisheye, or a distortion that folds over inside of the
 * picture.
 */
int lens_to_tsai(const struct lens *lens, struct tsai_camera *camera, double tolerance_px,
		 double *error_px, struct fault *fault);
/* Converts to a lens that looks straight up; its field is 90 degrees, or less if the picture or the
 * fold of the polynomial ends before. -EINVAL for a pinhole camera. */
int lens_to_fisheye(const struct lens *lens, struct fisheye_settings *settings,
		    struct fault *fault);

/* ---- files ---- */

enum lens_file { LENS_FILE_INI, LENS_FILE_OPENCV, LENS_FILE_ROS };

extern const char *const lens_file_names[]; /* "ini", "opencv", "ros", NULL */

/*
 * Reads a lens from the YAML of OpenCV's FileStorage, from ROS's calibration files and
 * camera_info messages as its tools print them (the first one), or from Kalibr's camchain. camera:
 * which of several cameras (Kalibr's cam0 ...); NULL: there is one. Keys that say nothing about a
 * lens are ignored. The caller presets lens->width, height and fisheye for files without them.
 * -ENOENT...; -EINVAL with file, line and what was expected.
 */
int lens_read_foreign(struct lens *lens, const char *path, const char *camera, struct fault *fault);

/* Writes the section that is given, as our INI file; from: name of the source, for a comment. */
void lens_write_ini(FILE *to, const struct lens_ini *ini, const char *from, double error_px);

/* Write files of OpenCV and ROS; error_px goes into a comment unless it is 0. */
void lens_write_opencv(FILE *to, const struct lens *lens, double error_px);
void lens_write_ros(FILE *to, const struct lens *lens, const char *name, double error_px);

#endif
