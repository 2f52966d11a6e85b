/* SPDX-License-Identifier: MIT */
/*
 * An equirectangular picture as an environment at infinity: radiance by direction.
 *
 * The picture's middle column looks along world +X (before the turn), columns to the right turn
 * clockwise seen from above (towards -Y), the top row is the zenith: not mirrored, as a person
 * inside sees it.
 */
#ifndef INLAY_HAL_OPTICS_PANORAMA_H
#define INLAY_HAL_OPTICS_PANORAMA_H

#include "hal/image/image.h"

struct panorama {
	const struct image *image; /* f32; not owned */
	double turn_rad;	   /* rotation of the environment about Z, counter-clockwise */
	double scale;		   /* radiance of 1.0 in the file */
};

/* Reads the picture of a panorama, which the caller frees. 0; -EINVAL: not linear light, or not
 * twice as wide as high to within a fortieth; other errors of image_read(). */
int panorama_read(struct image *image, const char *path, struct fault *fault);

/* Radiance R, G, B in a direction: bilinear, wrapped in azimuth, clamped at the poles. dir need not
 * be unit. */
void panorama_radiance(const struct panorama *panorama, const double dir[3], double rgb[3]);

/* Direction of a point in the picture (pixel centres at +0.5). */
void panorama_direction(const struct panorama *panorama, double x, double y, double dir[3]);

/* Solid angle of the whole row y, sr; that of a pixel is this / the picture's width. */
double panorama_row_sr(const struct panorama *panorama, int y);

#endif
