/* SPDX-License-Identifier: MIT */
#include "bake/truth/truth_views.h"

#include "hal/optics/fisheye.h"
#include "hal/optics/tsai.h"

#define SUBSAMPLES 4	  /* per side of a pixel */
#define SUBSAMPLES_MAX 64 /* of the fisheye, whose pixels may be coarser than texels */

static void background_pixel(const struct scene *scene, const struct panorama *panorama, int x,
			     int y, float out[3])
{
	double sum[3] = {0, 0, 0};
	int count = 0;

	for (int k = 0; k < SUBSAMPLES * SUBSAMPLES; k++) {
		const double px[2] = {x + (k % SUBSAMPLES + 0.5) / SUBSAMPLES,
				      y + (k / SUBSAMPLES + 0.5) / SUBSAMPLES};
		double origin[3], d[3], rgb[3];

		if (tsai_ray(&scene->camera, px, origin, d) < 0)
			continue;
		panorama_radiance(panorama, d, rgb);
		count++;
		for (int c = 0; c < 3; c++)
			sum[c] += rgb[c];
	}
	for (int c = 0; c < 3; c++)
		out[c] = count ? (float)(sum[c] / count) : 0;
}

int truth_background(const struct scene *scene, const struct panorama *panorama, struct image *out)
{
	const int width = scene->camera.width, height = scene->camera.height;
	const int err = image_create_f32(out, width, height);

	if (err)
		return err;
	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++)
			background_pixel(scene, panorama, x, y,
					 out->f32 + 3 * ((size_t)y * (size_t)width + (size_t)x));
	return 0;
}

static void fisheye_pixel(const struct panorama *panorama, const struct fisheye *lens, int x, int y,
			  int fineness, float out[3])
{
	double sum[3] = {0, 0, 0}, weight = 0;

	for (int k = 0; k < fineness * fineness; k++) {
		const double px[2] = {x + (k % fineness + 0.5) / fineness,
				      y + (k / fineness + 0.5) / fineness};
		double d[3], rgb[3], sr;

		if (!fisheye_ray(lens, px, d))
			continue;
		sr = fisheye_pixel_sr(lens, px);
		panorama_radiance(panorama, d, rgb);
		weight += sr;
		for (int c = 0; c < 3; c++)
			sum[c] += sr * rgb[c];
	}
	for (int c = 0; c < 3; c++)
		out[c] = weight > 0 ? (float)(sum[c] / weight) : 0;
}

int truth_fisheye(const struct panorama *panorama, int side, struct image *out)
{
	const struct fisheye_settings settings = {.field_deg = 90};
	/* four points a texel, so that a sun of one texel is not missed or counted twice */
	int fineness = (2 * panorama->image->width + side - 1) / side;
	struct fisheye lens;
	int err = fisheye_prepare(&lens, &settings, side, side, NULL);

	if (err)
		return err;
	fineness = fineness < SUBSAMPLES ? SUBSAMPLES : fineness;
	fineness = fineness > SUBSAMPLES_MAX ? SUBSAMPLES_MAX : fineness;
	err = image_create_f32(out, side, side);
	if (err)
		return err;
	for (int y = 0; y < side; y++)
		for (int x = 0; x < side; x++)
			fisheye_pixel(panorama, &lens, x, y, fineness,
				      out->f32 + 3 * ((size_t)y * (size_t)side + (size_t)x));
	return 0;
}
