/* SPDX-License-Identifier: MIT */
#include "tests/support/calibrate/drawn_lamps.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "hal/colour/transfer.h"
#include "hal/optics/vec.h"

void drawn_lamps_place(struct drawn_lamps *d, int count, double most_deg, struct chance *chance)
{
	struct fisheye lens;

	fisheye_prepare(&lens, d->lens, DRAWN_LAMPS_WIDTH, DRAWN_LAMPS_HEIGHT, NULL);
	d->lamps = (struct lamps){.lamp = d->lamp, .count = count};
	for (int n = 0; n < count; n++) {
		const double theta = most_deg * (M_PI / 180) * sqrt((n + 0.7) / count);
		const double phi = n * 2.39996 + chance_real(chance, 0, 0.7);
		const double ray[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};

		d->lamp[n] = (struct lamp){.line = n + 1};
		mat_apply_transposed(lens.rotation, ray, d->lamp[n].dir);
	}
}

/* Adds a round Gaussian spot of standard deviation sigma px. */
static void drawn_lamps_blob(float *light, const double px[2], double sigma, double peak)
{
	const int reach = (int)(5 * sigma) + 1;

	for (int y = (int)px[1] - reach; y <= (int)px[1] + reach; y++)
		for (int x = (int)px[0] - reach; x <= (int)px[0] + reach; x++) {
			const double dx = x + 0.5 - px[0], dy = y + 0.5 - px[1];

			if (x >= 0 && y >= 0 && x < DRAWN_LAMPS_WIDTH && y < DRAWN_LAMPS_HEIGHT)
				light[y * DRAWN_LAMPS_WIDTH + x] +=
					(float)(peak *
						exp(-(dx * dx + dy * dy) / (2 * sigma * sigma)));
		}
}

static void drawn_lamps_room(const struct drawn_lamps *d, const struct fisheye *lens, float *light)
{
	for (int p = 0; p < DRAWN_LAMPS_WIDTH * DRAWN_LAMPS_HEIGHT; p++) {
		const double px[2] = {p % DRAWN_LAMPS_WIDTH + 0.5, p / DRAWN_LAMPS_WIDTH + 0.5};
		double dir[3];

		if (!fisheye_ray(lens, px, dir))
			continue;
		light[p] = (float)(d->walls * (1 + 0.5 * dir[0] + 0.2 * sin(7 * dir[1])));
		if (d->window && dir[0] > 0.3 && dir[0] < 0.6 && fabs(dir[1]) < 0.2)
			light[p] = 1.5F;
	}
}

int drawn_lamps_draw(const struct drawn_lamps *d, struct image *image, struct chance *chance)
{
	float *light = calloc(DRAWN_LAMPS_WIDTH * DRAWN_LAMPS_HEIGHT, sizeof(*light));
	struct fisheye lens;

	if (!light || image_create_u8(image, DRAWN_LAMPS_WIDTH, DRAWN_LAMPS_HEIGHT)) {
		free(light);
		return -ENOMEM;
	}
	fisheye_prepare(&lens, d->lens, DRAWN_LAMPS_WIDTH, DRAWN_LAMPS_HEIGHT, NULL);
	drawn_lamps_room(d, &lens, light);
	for (int n = d->hidden; n < d->lamps.count; n++) {
		double px[2];

		if (fisheye_project(&lens, d->lamp[n].dir, px))
			drawn_lamps_blob(light, px, chance_real(chance, 1, 2.2), d->lamp_light);
	}
	for (int n = 0; n < d->reflections; n++) {
		const double px[2] = {chance_real(chance, 120, 520), chance_real(chance, 80, 400)};

		drawn_lamps_blob(light, px, chance_real(chance, 1, 2), chance_real(chance, 0.3, 3));
	}
	for (int p = 0; p < DRAWN_LAMPS_WIDTH * DRAWN_LAMPS_HEIGHT; p++) {
		const int at = d->mirrored ? p - p % DRAWN_LAMPS_WIDTH + DRAWN_LAMPS_WIDTH - 1 -
						     p % DRAWN_LAMPS_WIDTH
					   : p;
		const double code = 255 * transfer_encode(TRANSFER_SRGB, fmin(light[p], 1)) +
				    d->noise * chance_normal(chance);

		for (int c = 0; c < 3; c++)
			image->u8[3 * at + c] = (uint8_t)fmin(fmax(rint(code), 0), 255);
	}
	free(light);
	return 0;
}
