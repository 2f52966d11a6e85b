/* SPDX-License-Identifier: MIT */
/*
 * The curves of fisheye lenses: from the angle theta from the axis to the radius r in the picture,
 * in focal lengths, and back.
 *
 *     equidistant    r = theta
 *     equisolid      r = 2 sin(theta / 2)
 *     stereographic  r = 2 tan(theta / 2)
 *     orthographic   r = sin(theta)
 *     polynomial     r = theta + k1 theta^3 + k2 theta^5 + k3 theta^7 + k4 theta^9
 *
 * The first is the thesis's (equations 2.10 to 2.13). The last is Kannala and Brandt's (A Generic
 * Camera Model and Calibration Method, 2006), with the terms of OpenCV's fisheye module and of
 * ROS's "equidistant". All have slope 1 on the axis. Angles are in radians.
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

/* r(theta), by the table above. */
double fisheye_curve_radius(const struct fisheye_curve *curve, double theta);

/* r'(theta) = dr / dtheta */
double fisheye_curve_slope(const struct fisheye_curve *curve, double theta);

/* The angle of a radius, clamped to 0..most. The curve must rise from 0 to most. */
double fisheye_curve_angle(const struct fisheye_curve *curve, double radius, double most);

/* Solid angle per area of the picture in focal lengths squared:
 *     sine / (radius * slope)        1 on the axis; sine = sin(theta)
 * For the orthographic curve it has no bound towards 90 degrees. */
double fisheye_curve_patch_sr(const struct fisheye_curve *curve, double theta, double sine);

/* The fold: the first angle in 0..most beyond which the curve does not rise, or INFINITY. */
double fisheye_curve_fold(const struct fisheye_curve *curve, double most);

/* The smallest root in 0..most of c[0] + c[1] x + ... + c[degree] x^degree, degree <= 4, or
 * INFINITY. Where the polynomial touches 0 without crossing it, rounding decides. */
double fisheye_first_root(const double *c, int degree, double most);

#endif
