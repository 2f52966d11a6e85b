/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/lamps/lamp_sight.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "hal/base/log.h"

/* A lamp of three quarters of the light, 1.5 m away and taken for distant, puts the picture off by 6.4 levels
 * (tests/accuracy, "Lamps in the room"); one of half a hundredth by a twentieth of a level. */
#define FAINT 0.005
/* JPEG and sharpening leave what is clipped some code values below white. */
#define CLIPPED_CODE 0.97

const char *lamp_sight_text(const double dir[3], char text[SIGHT_TEXT_MAX])
{
	const double azimuth = atan2(dir[1], dir[0]) * (180 / M_PI);

	snprintf(text, SIGHT_TEXT_MAX, "azimuth %.0f, elevation %.0f degrees",
		 azimuth < 0 ? azimuth + 360 : azimuth,
		 asin(fmax(-1, fmin(1, dir[2]))) * (180 / M_PI));
	return text;
}

/* The largest channel of each pixel in linear light: what clips, clips there first. */
static float *strongest_channel(const struct image *picture, const struct transfer_curve *curve)
{
	const size_t pixels = (size_t)picture->width * (size_t)picture->height;
	float *light = malloc(pixels * sizeof(*light));
	float decode[256];

	if (!light)
		return NULL;
	for (int code = 0; code < 256; code++)
		decode[code] = (float)transfer_curve_decode(curve, code / 255.0);
	for (size_t p = 0; p < pixels; p++) {
		float most = 0;

		for (size_t c = 0; c < 3; c++)
			most = fmaxf(most, picture->u8 ? decode[picture->u8[3 * p + c]]
						       : picture->f32[3 * p + c]);
		light[p] = most;
	}
	return light;
}

/* The light of a level ground: the sum of radiance, solid angle and cosine. */
static double ground_light(const struct lamp_picture *p)
{
	double sum = 0;

	for (int y = 0; y < p->height; y++)
		for (int x = 0; x < p->width; x++) {
			const double at[2] = {x + 0.5, y + 0.5};
			struct fisheye_pixel pixel;

			if (fisheye_pixel_of(p->lens, at, &pixel) && pixel.dir[2] > 0)
				sum += (double)p->light[y * p->width + x] * pixel.sr * pixel.dir[2];
		}
	return sum;
}

/* Keeps what can be a lamp of the spots that were found. */
static void keep_lamps(struct lamp_sight *s, double all)
{
	int kept = 0, below = 0, faint = 0;
	char text[SIGHT_TEXT_MAX];

	for (int k = 0; k < s->count; k++) {
		const struct lamp_spot *spot = &s->spot[k];
		const double share = spot->flux * spot->dir[2] / all;

		if (spot->dir[2] <= 0) {
			below++;
			lamp_sight_text(spot->dir, text);
		} else if (!spot->clipped && share < FAINT) {
			faint++;
		} else {
			s->share[kept] = share;
			s->spot[kept++] = *spot;
		}
	}
	s->count = kept;
	if (below)
		log_info("%s: %d below the horizon left out as reflections, the strongest at %s",
			 s->name, below, text);
	if (faint)
		log_info("%s: %d left out, each with less than %g %% of the light", s->name, faint,
			 100 * FAINT);
}

int lamp_sight_look(struct lamp_sight *sight, const struct image *picture,
		    const struct transfer_curve *curve, const struct fisheye *lens)
{
	struct lamp_picture p = {.width = picture->width,
				 .height = picture->height,
				 .lens = lens,
				 .white = INFINITY};
	struct lamp_finder finder = {.pixels = 0};
	float *light = strongest_channel(picture, curve);

	if (!light)
		return -ENOMEM;
	p.light = light;
	if (picture->u8)
		p.white = (float)transfer_curve_decode(curve, CLIPPED_CODE);
	sight->count = lamp_find(&finder, &p, sight->spot, SIGHT_SPOTS_MAX);
	if (sight->count > 0)
		keep_lamps(sight, ground_light(&p));
	lamp_finder_free(&finder);
	free(light);
	return sight->count < 0 ? sight->count : 0;
}
