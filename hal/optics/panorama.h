/* SPDX-License-Identifier: MIT */
/*
 * An equirectangular picture as a surrounding at infinity: radiance by direction.
 *
 * The picture's middle column looks along world +X (before rotation), columns to the right turn
 * clockwise seen from above (towards -Y), the top row is the zenith: what a person standing inside
 * sees, not mirrored.
 */
#ifndef INLAY_HAL_OPTICS_PANORAMA_H
#define INLAY_HAL_OPTICS_PANORAMA_H

#include "hal/image/image.h"

struct panorama {
	const struct image *image; /* f32; not owned */
	double turn_rad; /* the surrounding is turned by this about Z, counter-clockwise */
	double scale;	 /* radiance of 1.0 in the file */
};

/* The picture of a panorama: linear light, twice as wide as high to within a fortieth. What
 * image_read() returns; -EINVAL: it is none. */
int panorama_read(struct image *image, const char *path, struct fault *fault);

/* Bilinear, wrapped in azimuth, clamped at the poles. dir need not be unit. */
void panorama_radiance(const struct panorama *panorama, const double dir[3], double rgb[3]);

/* Direction of a point in the picture (pixel centres at +0.5). */
void panorama_direction(const struct panorama *panorama, double x, double y, double dir[3]);

/* Solid angle of the whole row y; each of its pixels has this over the picture's width. */
double panorama_row_sr(const struct panorama *panorama, int y);

#endif
