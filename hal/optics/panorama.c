/* SPDX-License-Identifier: MIT */
#include "hal/optics/panorama.h"

#include <errno.h>
#include <math.h>

#define ASPECT_SLACK 0.05 /* tolerance of width / height, for pictures scaled by hand */

int panorama_read(struct image *image, const char *path, struct fault *fault)
{
	int err = image_read(path, image, fault);

	if (err)
		return err;
	if (!image->f32)
		err = fault_say(
			fault, -EINVAL,
			"%s: 8-bit code values, expected linear light: a panorama in .hdr, .pfm or .exr",
			path);
	else if (fabs((double)image->width / image->height - 2) > ASPECT_SLACK)
		err = fault_say(
			fault, -EINVAL,
			"%s: %d x %d pixels, expected twice as wide as high: the whole sphere, equirectangular",
			path, image->width, image->height);
	if (err)
		image_free(image);
	return err;
}

static int column_wrap(int x, int width)
{
	x %= width;
	return x < 0 ? x + width : x;
}

static int row_clamp(int y, int height)
{
	return y < 0 ? 0 : y >= height ? height - 1 : y;
}

void panorama_radiance(const struct panorama *panorama, const double dir[3], double rgb[3])
{
	const struct image *image = panorama->image;
	const double theta = atan2(hypot(dir[0], dir[1]), dir[2]);
	const double phi = atan2(dir[1], dir[0]) - panorama->turn_rad;
	const double x = image->width * (0.5 - phi / (2 * M_PI)) - 0.5;
	const double y = image->height * (theta / M_PI) - 0.5;
	const double column = floor(x), row = floor(y);
	double weight[2][2];

	rgb[0] = rgb[1] = rgb[2] = 0;
	if (!(fabs(column) < 1e9)) /* NaN in the direction, or an absurd turn */
		return;
	weight[0][0] = (1 - (x - column)) * (1 - (y - row));
	weight[0][1] = (x - column) * (1 - (y - row));
	weight[1][0] = (1 - (x - column)) * (y - row);
	weight[1][1] = (x - column) * (y - row);
	for (int j = 0; j < 2; j++)
		for (int i = 0; i < 2; i++) {
			const size_t at = (size_t)row_clamp((int)row + j, image->height) *
						  image->width +
					  column_wrap((int)column + i, image->width);

			for (int c = 0; c < 3; c++)
				rgb[c] += panorama->scale * weight[j][i] * image->f32[3 * at + c];
		}
}

void panorama_direction(const struct panorama *panorama, double x, double y, double dir[3])
{
	const double phi = panorama->turn_rad + 2 * M_PI * (0.5 - x / panorama->image->width);
	const double theta = M_PI * y / panorama->image->height;

	dir[0] = sin(theta) * cos(phi);
	dir[1] = sin(theta) * sin(phi);
	dir[2] = cos(theta);
}

/* 2 pi (cos a - cos b), with the difference as a product, whose digits do not cancel at the
 * poles. */
double panorama_row_sr(const struct panorama *panorama, int y)
{
	const double step = M_PI / panorama->image->height;

	return 2 * M_PI * 2 * sin(step * (y + 0.5)) * sin(0.5 * step);
}
