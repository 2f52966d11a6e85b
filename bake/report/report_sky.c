/* SPDX-License-Identifier: MIT */
#include "bake/report/report_parts.h"

#include <math.h>
#include <stdbool.h>

#include "hal/optics/panorama.h"

#define SUBSAMPLES 4   /* per side of a texel, for the edges of lamps */
#define EYE_HEIGHT 1.2 /* above the floor, in tiles */

const char *const report_sky_names[] = {"overcast", "sun", "lamps", NULL};

enum { OVERCAST, SUN, LAMPS };

/* A round light: the sun, or a lamp. */
struct disc {
	double height_deg, azimuth_deg, radius_deg;
	double rgb[3];
};

static const struct disc sun = {38, -125, 1.2, {9000, 8200, 6800}};

/* A warm lamp, a cool one, and a small one that is very bright. */
static const struct disc lamps[] = {
	{52, -70, 9, {60, 52, 40}},
	{30, 160, 7, {26, 32, 44}},
	{68, 20, 1.5, {900, 860, 800}},
};

static bool is_inside(const struct disc *disc, const double d[3])
{
	const double height = disc->height_deg * M_PI / 180;
	const double azimuth = disc->azimuth_deg * M_PI / 180;
	const double to[3] = {cos(height) * cos(azimuth), cos(height) * sin(azimuth), sin(height)};

	return d[0] * to[0] + d[1] * to[1] + d[2] * to[2] > cos(disc->radius_deg * M_PI / 180);
}

/* CIE: three times brighter at the zenith. */
static void overcast_sky(const double d[3], double rgb[3])
{
	for (int c = 0; c < 3; c++)
		rgb[c] = (1 + 2 * d[2]) / 3;
}

/* Blue above, whiter below and around the sun. */
static void clear_sky(const double d[3], double rgb[3])
{
	static const double above[3] = {0.18, 0.36, 0.8}, below[3] = {0.75, 0.85, 0.95};
	const double height = sun.height_deg * M_PI / 180;
	const double azimuth = sun.azimuth_deg * M_PI / 180;
	const double cosine = cos(height) * (cos(azimuth) * d[0] + sin(azimuth) * d[1]) +
			      sin(height) * d[2];
	const double glow = 4 * exp(12 * (cosine - 1));

	for (int c = 0; c < 3; c++) {
		rgb[c] = above[c] + (below[c] - above[c]) * pow(1 - d[2], 3) + glow * below[c];
		if (is_inside(&sun, d))
			rgb[c] = sun.rgb[c];
	}
}

/* A dim room: grey walls, a window, lamps. */
static void lamp_room(const double d[3], double rgb[3])
{
	static const double wall[3] = {0.10, 0.09, 0.08}, window[3] = {5, 6, 7.5};
	const double azimuth = atan2(d[1], d[0]);
	const bool in_window = d[2] > 0.15 && d[2] < 0.5 && fabs(azimuth - 2.6) < 0.3;

	for (int c = 0; c < 3; c++)
		rgb[c] = in_window ? window[c] : wall[c] * (0.6 + d[2]);
	for (size_t k = 0; k < sizeof(lamps) / sizeof(*lamps); k++)
		for (int c = 0; c < 3; c++)
			if (is_inside(&lamps[k], d))
				rgb[c] = lamps[k].rgb[c];
}

/* Light and dark tiles; far ones blur into their mean. */
static void floor_of(const double d[3], double rgb[3])
{
	static const double light[3] = {0.62, 0.60, 0.56}, dark[3] = {0.20, 0.19, 0.18};
	const double away = -EYE_HEIGHT / fmin(d[2], -1e-3);
	const double x = away * d[0], y = away * d[1];
	const double share = ((int)floor(x) + (int)floor(y)) & 1 ? 1 : 0;
	const double near = exp(-0.02 * away * away);

	for (int c = 0; c < 3; c++) {
		const double mean = (light[c] + dark[c]) / 2;

		rgb[c] = mean + near * (share * light[c] + (1 - share) * dark[c] - mean);
	}
}

static void made_radiance(int which, const double d[3], double rgb[3])
{
	static void (*const sky[])(const double d[3], double rgb[3]) = {
		[OVERCAST] = overcast_sky, [SUN] = clear_sky, [LAMPS] = lamp_room};

	if (d[2] < 0)
		floor_of(d, rgb);
	else
		sky[which](d, rgb);
}

/* Lights the floor by the sky. So far its pixels hold its reflectance. */
static void light_floor(const struct panorama *panorama)
{
	const struct image *image = panorama->image;
	double white[3] = {0, 0, 0};

	for (int y = 0; y < image->height / 2; y++) {
		const double sr = panorama_row_sr(panorama, y) / image->width;

		for (int x = 0; x < image->width; x++) {
			double d[3];

			panorama_direction(panorama, x + 0.5, y + 0.5, d);
			for (int c = 0; c < 3; c++)
				white[c] += sr * d[2] / M_PI *
					    (double)image->f32[3 * (y * image->width + x) + c];
		}
	}
	for (int at = image->height / 2 * image->width; at < image->height * image->width; at++)
		for (int c = 0; c < 3; c++)
			image->f32[3 * at + c] *= (float)white[c];
}

int report_sky_make(struct image *image, int which, int width)
{
	const struct panorama panorama = {.image = image, .scale = 1};
	const int err = image_create_f32(image, width, width / 2);

	if (err)
		return err;
	for (int at = 0; at < image->width * image->height; at++) {
		double sum[3] = {0, 0, 0};

		for (int k = 0; k < SUBSAMPLES * SUBSAMPLES; k++) {
			const double x = at % width + (k % SUBSAMPLES + 0.5) / SUBSAMPLES;
			const double y = at / width + (k / SUBSAMPLES + 0.5) / SUBSAMPLES;
			double d[3], rgb[3];

			panorama_direction(&panorama, x, y, d);
			made_radiance(which, d, rgb);
			for (int c = 0; c < 3; c++)
				sum[c] += rgb[c];
		}
		for (int c = 0; c < 3; c++)
			image->f32[3 * at + c] = (float)(sum[c] / SUBSAMPLES / SUBSAMPLES);
	}
	light_floor(&panorama);
	return 0;
}
