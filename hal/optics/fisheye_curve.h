/* SPDX-License-Identifier: MIT */
/*
 * How far from the axis a fisheye shows what lies at an angle from it, in focal lengths, and back.
 *
 *     equidistant    r = theta
 *     equisolid      r = 2 sin(theta / 2)
 *     stereographic  r = 2 tan(theta / 2)
 *     orthographic   r = sin(theta)
 *     polynomial     r = theta + k1 theta^3 + k2 theta^5 + k3 theta^7 + k4 theta^9
 *
 * The first is the thesis's (equations 2.10 to 2.13); the last is Kannala and Brandt's (A Generic
 * Camera Model and Calibration Method, 2006), as OpenCV's fisheye module and ROS's "equidistant"
 * have it. All have slope 1 on the axis.
 */
#ifndef INLAY_HAL_OPTICS_FISHEYE_CURVE_H
#define INLAY_HAL_OPTICS_FISHEYE_CURVE_H

#define FISHEYE_TERMS 4 /* of the polynomial */

enum fisheye_model {
	FISHEYE_EQUIDISTANT,
	FISHEYE_EQUISOLID,
	FISHEYE_STEREOGRAPHIC,
	FISHEYE_ORTHOGRAPHIC,
	FISHEYE_POLYNOMIAL,
	FISHEYE_MODEL_COUNT
};

extern const char *const fisheye_model_names[]; /* "equidistant", ..., "polynomial", NULL */

struct fisheye_curve {
	enum fisheye_model model;
	double k[FISHEYE_TERMS]; /* of the polynomial */
};

double fisheye_curve_radius(const struct fisheye_curve *curve, double theta);

/* d radius / d theta */
double fisheye_curve_slope(const struct fisheye_curve *curve, double theta);

/* The angle of a radius on the branch from the axis to most, up to which the curve rises: in
 * 0..most for any radius. */
double fisheye_curve_angle(const struct fisheye_curve *curve, double radius, double most);

/* sin(theta) / (radius * slope): the solid angle, in focal lengths squared, of a patch of area 1;
 * 1 on the axis. The orthographic one's has no bound towards 90 degrees. */
double fisheye_curve_patch_sr(const struct fisheye_curve *curve, double theta);

/* The first angle in 0..most beyond which the curve does not rise, or INFINITY. */
double fisheye_curve_fold(const struct fisheye_curve *curve, double most);

/* The smallest root in 0..most of c[0] + c[1] x + ... + c[degree] x^degree, or INFINITY. Degree 4
 * at most. Where it touches 0 without crossing it, rounding decides. */
double fisheye_first_root(const double *c, int degree, double most);

#endif
