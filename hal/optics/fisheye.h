/*
 * The fisheye lens: equidistant projection r = f theta (thesis equations 2.10 to 2.13), with
 * separate horizontal and vertical focal lengths because the digitizer squashes.
 *
 * Camera axes: x right, y down, z out of the lens. Unrotated, the camera lies on its back with the
 * lens to the zenith: camera x is world X, camera y is world Y, camera z is world Z. Then
 *     ix = cx + fx theta cos(phi),   iy = cy + fy theta sin(phi)
 * with theta from the zenith and phi from +X towards +Y: a picture of the sky as seen from below.
 *
 * Pixel coordinates: x right, y down, pixel (column, row) has its centre at (column + 0.5,
 * row + 0.5), upright picture (after the view's flips).
 */
#ifndef INLAY_HAL_OPTICS_FISHEYE_H
#define INLAY_HAL_OPTICS_FISHEYE_H

#include <stdbool.h>

#include "hal/fault.h"
#include "hal/ini/ini.h"

struct fisheye {
	double focal_px[2]; /* pixels per radian, horizontal and vertical; > 0 */
	double centre_px[2];
	double rotation_deg[3]; /* about X, then Y, then Z: camera = Rz Ry Rx world */
	double field_rad;	/* directions beyond this angle from the axis are not seen; <= pi */
	double rotation[9];	/* world to camera, made from rotation_deg by fisheye_prepare() */
};

/* Keys of a fisheye (focal, centre, rotation, field) for an INI table; field is in degrees there.
 */
extern const struct ini_key fisheye_keys[];

struct fisheye_settings {
	double focal_px[2];  /* 0 0: from the image circle: half the smaller side over field */
	double centre_px[2]; /* 0 0: the middle of the picture */
	double rotation_deg[3];
	double field_deg; /* half the field of view: 90 for a hemisphere */
};

/* Fills in defaults for a picture of this size, and the rotation. -EINVAL for values out of range.
 */
int fisheye_prepare(struct fisheye *lens, const struct fisheye_settings *settings, int width,
		    int height, struct fault *fault);

/* False when the direction lies outside the field. dir need not be unit. */
bool fisheye_project(const struct fisheye *lens, const double dir[3], double px[2]);

/* Unit world direction of a point in the picture; false outside the field. */
bool fisheye_ray(const struct fisheye *lens, const double px[2], double dir[3]);

/* Solid angle that a pixel-sized patch at px covers, sr: sin(theta) / (theta fx fy), with the limit
 * 1 / (fx fy) on the axis; 0 outside the field. */
double fisheye_pixel_sr(const struct fisheye *lens, const double px[2]);

#endif
