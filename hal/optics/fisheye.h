/* SPDX-License-Identifier: MIT */
/*
 * The fisheye lens: what lies at an angle theta from its axis is seen at a distance r(theta) from
 * the centre, equidistant (r = f theta, thesis equations 2.10 to 2.13) or by another of the curves
 * in fisheye_curve.h, with separate horizontal and vertical focal lengths because the digitizer
 * squashes.
 *
 * Camera axes: x right, y down, z out of the lens. Unrotated, the camera lies on its back with the
 * lens to the zenith: camera x is world X, camera y is world Y, camera z is world Z. Then
 *     ix = cx + fx r(theta) cos(phi),   iy = cy + fy r(theta) sin(phi)
 * with theta from the zenith and phi from +X towards +Y: a picture of the sky as seen from below.
 *
 * Towards the rim a lens passes less light: of the light on the axis it lets through
 *     1 + v1 theta^2 + v2 theta^4 + v3 theta^6,   theta in radians.
 *
 * Pixel coordinates: x right, y down, pixel (column, row) has its centre at (column + 0.5,
 * row + 0.5), upright picture (after the view's flips).
 */
#ifndef INLAY_HAL_OPTICS_FISHEYE_H
#define INLAY_HAL_OPTICS_FISHEYE_H

#include <stdbool.h>

#include "hal/base/fault.h"
#include "hal/ini/ini.h"
#include "hal/optics/fisheye_curve.h"

#define FISHEYE_FALLOFF_TERMS 3

struct fisheye {
	struct fisheye_curve curve;
	double focal_px[2]; /* pixels per radian on the axis, horizontal and vertical; > 0 */
	double centre_px[2];
	double rotation_deg[3]; /* about X, then Y, then Z: camera = Rz Ry Rx world */
	double field_rad;	/* directions beyond this angle from the axis are not seen; <= pi */
	double falloff[FISHEYE_FALLOFF_TERMS];
	/* Made by fisheye_prepare(): */
	double rotation[9]; /* world to camera */
	double rim;	    /* r(field) in focal lengths */
};

/* Keys of a fisheye (model, polynomial, focal, centre, rotation, field, falloff) for an INI table;
 * field is in degrees there. */
extern const struct ini_key fisheye_keys[];

struct fisheye_settings {
	double focal_px[2];  /* 0 0: from the image circle: half the smaller side over r(field) */
	double centre_px[2]; /* 0 0: the middle of the picture */
	double rotation_deg[3];
	double field_deg;		  /* half the field of view: 90 for a hemisphere */
	int model;			  /* enum fisheye_model */
	double polynomial[FISHEYE_TERMS]; /* k1..k4; of the polynomial model alone */
	double falloff[FISHEYE_FALLOFF_TERMS];
};

/*
 * Fills in defaults for a picture of this size, and the rotation. -EINVAL for values out of range:
 * among them a field in which the model folds over (the fault says at which angle), more than 90
 * degrees of an orthographic lens, 180 of a stereographic one, and a falloff that leaves no light
 * inside the field.
 */
int fisheye_prepare(struct fisheye *lens, const struct fisheye_settings *settings, int width,
		    int height, struct fault *fault);

/* False when the direction lies outside the field. dir need not be unit. */
bool fisheye_project(const struct fisheye *lens, const double dir[3], double px[2]);

/* Unit world direction of a point in the picture; false outside the field. */
bool fisheye_ray(const struct fisheye *lens, const double px[2], double dir[3]);

/* Solid angle that a pixel-sized patch at px covers, sr: sin(theta) / (r r' fx fy), with the limit
 * 1 / (fx fy) on the axis; 0 outside the field. An orthographic lens squeezes the last degrees
 * before 90 so that this has no bound; what it is half a pixel inside of the rim is its largest. */
double fisheye_pixel_sr(const struct fisheye *lens, const double px[2]);

/* The share of the light at px that the lens passes, > 0: 1 on the axis and outside the field. */
double fisheye_falloff(const struct fisheye *lens, const double px[2]);

/* Turn about X, then Y, then Z: Rz Ry Rx, in rows. */
void fisheye_rotation(const double deg[3], double rotation[9]);

#endif
