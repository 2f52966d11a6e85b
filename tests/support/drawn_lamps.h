/* SPDX-License-Identifier: MIT */
/* Lamps all over the sky as a fisheye sees them, with what else may be bright. */
#ifndef INLAY_TESTS_SUPPORT_DRAWN_LAMPS_H
#define INLAY_TESTS_SUPPORT_DRAWN_LAMPS_H

#include <errno.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>

#include "bake/calibrate/fisheye/lamps/lamps_file.h"
#include "hal/colour/transfer.h"
#include "hal/image/image.h"
#include "tests/support/fisheye_views.h"

enum { LAMPS_WIDTH = 640, LAMPS_HEIGHT = 480, DRAWN_LAMPS_MAX = 100 };

/* What is drawn besides the lamps. */
struct drawn_lamps {
	const struct fisheye_settings *lens;
	double walls;	   /* light of the room */
	double lamp_light; /* of a lamp's middle; 1 is white */
	double noise;	   /* code values */
	int reflections, hidden;
	bool mirrored, window;
	struct lamps lamps;
	struct lamp lamp[DRAWN_LAMPS_MAX];
};

/* Lamps all over the field, irregularly. */
static inline void drawn_lamps_place(struct drawn_lamps *d, int count, double most_deg,
				     struct chance *chance)
{
	struct fisheye lens;

	fisheye_prepare(&lens, d->lens, LAMPS_WIDTH, LAMPS_HEIGHT, NULL);
	d->lamps = (struct lamps){.lamp = d->lamp, .count = count};
	for (int n = 0; n < count; n++) {
		const double theta = most_deg * (M_PI / 180) * sqrt((n + 0.7) / count);
		const double phi = n * 2.39996 + chance_real(chance, 0, 0.7);
		const double ray[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};

		d->lamp[n] = (struct lamp){.line = n + 1};
		mat_apply_transposed(lens.rotation, ray, d->lamp[n].dir);
	}
}

/* Round, and as soft as such lenses have it. */
static inline void add_blob(float *light, const double px[2], double sigma, double peak)
{
	const int reach = (int)(5 * sigma) + 1;

	for (int y = (int)px[1] - reach; y <= (int)px[1] + reach; y++)
		for (int x = (int)px[0] - reach; x <= (int)px[0] + reach; x++) {
			const double dx = x + 0.5 - px[0], dy = y + 0.5 - px[1];

			if (x >= 0 && y >= 0 && x < LAMPS_WIDTH && y < LAMPS_HEIGHT)
				light[y * LAMPS_WIDTH + x] +=
					(float)(peak *
						exp(-(dx * dx + dy * dy) / (2 * sigma * sigma)));
		}
}

static inline void light_room(const struct drawn_lamps *d, const struct fisheye *lens, float *light)
{
	for (int p = 0; p < LAMPS_WIDTH * LAMPS_HEIGHT; p++) {
		const double px[2] = {p % LAMPS_WIDTH + 0.5, p / LAMPS_WIDTH + 0.5};
		double dir[3];

		if (!fisheye_ray(lens, px, dir))
			continue;
		light[p] = (float)(d->walls * (1 + 0.5 * dir[0] + 0.2 * sin(7 * dir[1])));
		if (d->window && dir[0] > 0.3 && dir[0] < 0.6 && fabs(dir[1]) < 0.2)
			light[p] = 1.5F;
	}
}

/* The picture of them. -ENOMEM. */
static inline int drawn_lamps_draw(const struct drawn_lamps *d, struct image *image,
				   struct chance *chance)
{
	float *light = calloc(LAMPS_WIDTH * LAMPS_HEIGHT, sizeof(*light));
	struct fisheye lens;

	if (!light || image_create_u8(image, LAMPS_WIDTH, LAMPS_HEIGHT)) {
		free(light);
		return -ENOMEM;
	}
	fisheye_prepare(&lens, d->lens, LAMPS_WIDTH, LAMPS_HEIGHT, NULL);
	light_room(d, &lens, light);
	for (int n = d->hidden; n < d->lamps.count; n++) {
		double px[2];

		if (fisheye_project(&lens, d->lamp[n].dir, px))
			add_blob(light, px, chance_real(chance, 1, 2.2), d->lamp_light);
	}
	for (int n = 0; n < d->reflections; n++) {
		const double px[2] = {chance_real(chance, 120, 520), chance_real(chance, 80, 400)};

		add_blob(light, px, chance_real(chance, 1, 2), chance_real(chance, 0.3, 3));
	}
	for (int p = 0; p < LAMPS_WIDTH * LAMPS_HEIGHT; p++) {
		const int at = d->mirrored ? p - p % LAMPS_WIDTH + LAMPS_WIDTH - 1 - p % LAMPS_WIDTH
					   : p;
		const double code = 255 * transfer_encode(TRANSFER_SRGB, fmin(light[p], 1)) +
				    d->noise * chance_normal(chance);

		for (int c = 0; c < 3; c++)
			image->u8[3 * at + c] = (uint8_t)fmin(fmax(rint(code), 0), 255);
	}
	free(light);
	return 0;
}

#endif
