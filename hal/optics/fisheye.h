/* SPDX-License-Identifier: MIT */
/* The fisheye camera, and the curve of its lens. */
#ifndef INLAY_HAL_OPTICS_FISHEYE_H
#define INLAY_HAL_OPTICS_FISHEYE_H

#include <stdbool.h>

#include "hal/base/fault.h"
#include "hal/ini/ini.h"

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

/*
 * The fisheye lens: a direction at the angle theta from the axis is seen at the distance r(theta)
 * from the centre, by the equidistant model r = f theta (thesis equations 2.10 to 2.13) or another
 * curve above. Horizontal and vertical focal length differ, because the digitizer
 * squashes the picture.
 *
 * Camera axes: x right, y down, z out of the lens. Unrotated, the camera lies on its back with the
 * lens to the zenith: camera x is world X, camera y is world Y, camera z is world Z. Then
 *     ix = cx + fx r(theta) cos(phi),   iy = cy + fy r(theta) sin(phi)
 * with theta from the zenith and phi from +X towards +Y: a picture of the sky as seen from below.
 *
 * Falloff: a lens passes less light towards its rim. Of the light on the axis it passes the share
 *     1 + v1 theta^2 + v2 theta^4 + v3 theta^6,   theta in radians.
 *
 * Pixel coordinates: x right, y down, pixel (column, row) has its centre at (column + 0.5,
 * row + 0.5), in the upright picture (after the view's flips).
 */

#define FISHEYE_FALLOFF_TERMS 3

struct fisheye {
	struct fisheye_curve curve;
	double focal_px[2]; /* pixels per radian on the axis, horizontal and vertical; > 0 */
	double centre_px[2];
	double rotation_deg[3]; /* about X, then Y, then Z: camera = Rz Ry Rx world */
	double field_rad;	/* largest angle from the axis that the lens sees; <= pi */
	double falloff[FISHEYE_FALLOFF_TERMS];
	/* Computed by fisheye_prepare(): */
	double rotation[9]; /* world to camera */
	double rim;	    /* r(field) in focal lengths */
};

/* Keys of a fisheye (model, polynomial, focal, centre, rotation, field, falloff) for an INI table;
 * field is in degrees there. */
extern const struct ini_key fisheye_keys[];

struct fisheye_settings {
	double focal_px[2];  /* 0 0: the image circle fills the smaller side: side / 2 / r(field) */
	double centre_px[2]; /* 0 0: the middle of the picture */
	double rotation_deg[3];
	double field_deg;		  /* half the field of view: 90 for a hemisphere */
	int model;			  /* enum fisheye_model */
	double polynomial[FISHEYE_TERMS]; /* k1..k4; only for the polynomial model */
	double falloff[FISHEYE_FALLOFF_TERMS];
};

/*
 * Checks settings and fills a lens for a picture of this size. 0; -EINVAL: a value out of range;
 * also a field in which the model folds over (the fault says at which angle), more than 90 degrees
 * of an orthographic lens, 180 degrees of a stereographic one, or a falloff that reaches 0 inside
 * the field.
 */
int fisheye_prepare(struct fisheye *lens, const struct fisheye_settings *settings, int width,
		    int height, struct fault *fault);

/* Projects a world direction into the picture. False: outside the field. dir need not be unit. */
bool fisheye_project(const struct fisheye *lens, const double dir[3], double px[2]);

/* Unit world direction of a point in the picture. False: outside the field. */
bool fisheye_ray(const struct fisheye *lens, const double px[2], double dir[3]);

/* Solid angle of a pixel at px, in sr, 0 outside the field:
 *     sin(theta) / (r r' fx fy)        1 / (fx fy) on the axis
 * For an orthographic lens this has no bound towards 90 degrees; the result is limited to the value
 * half a pixel inside the rim. */
double fisheye_pixel_sr(const struct fisheye *lens, const double px[2]);

/* Direction, solid angle and falloff at px at once, the same as one by one. False: outside the
 * field. */
struct fisheye_pixel {
	double dir[3], sr, falloff;
};
bool fisheye_pixel_of(const struct fisheye *lens, const double px[2], struct fisheye_pixel *pixel);

/* Bound of the angle by which the direction turns from one point of the picture to another, rad per
 * pixel of their distance; infinite where the curve becomes flat. */
double fisheye_turn_per_pixel(const struct fisheye *lens);

/* The falloff at px: the share of light that the lens passes, > 0; 1 on the axis and outside the
 * field. */
double fisheye_falloff(const struct fisheye *lens, const double px[2]);

/* Rotation about X, then Y, then Z: Rz Ry Rx, row by row. */
void fisheye_rotation(const double deg[3], double rotation[9]);

#endif
