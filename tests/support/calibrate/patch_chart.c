/* SPDX-License-Identifier: MIT */
#include "tests/support/calibrate/patch_chart.h"

#include <math.h>

#include "hal/colour/transfer.h"

const char *const chart_curve_names[CHART_COUNT] = {"srgb", "bt709", "power 2.2", "film", "linear"};

/* The inverse of chart_curve_decode(). */
static double chart_curve_encode(enum chart_curve curve, double l)
{
	const double g = transfer_encode(TRANSFER_SRGB, l);

	l = fmin(fmax(l, 0), 1);
	switch (curve) {
	case CHART_SRGB:
		return g;
	case CHART_BT709:
		return transfer_encode(TRANSFER_BT709, l);
	case CHART_POWER:
		return pow(l, 1 / 2.2);
	case CHART_FILM:
		return 0.4 * g + 0.6 * g * g * (3 - 2 * g);
	default:
		return l;
	}
}

double chart_curve_decode(enum chart_curve curve, double u)
{
	double low = 0, high = 1;

	for (int i = 0; i < 60; i++) {
		const double middle = (low + high) / 2;

		if (chart_curve_encode(curve, middle) < u)
			low = middle;
		else
			high = middle;
	}
	return (low + high) / 2;
}

double chart_noise(struct chance *chance)
{
	double sum = -6;

	for (int i = 0; i < 12; i++)
		sum += chance_real(chance, 0, 1);
	return sum;
}

uint8_t chart_code(const struct chart_camera *camera, double linear, struct chance *chance)
{
	const double seen = linear + camera->read_noise * chart_noise(chance) +
			    camera->shot_noise * sqrt(fmin(fmax(linear, 0), 1)) *
				    chart_noise(chance);
	const double e = chart_curve_encode(camera->curve, seen);

	return (uint8_t)lrint(camera->black + (255 - camera->black) * e);
}

void chart_photograph(const struct chart_camera *camera, double time, double range,
		      struct chance *chance, struct image *picture)
{
	const int across = picture->width / 16, patches = across * (picture->height / 16);

	for (int y = 0; y < picture->height; y++) {
		for (int x = 0; x < picture->width; x++) {
			const int patch = y / 16 * across + x / 16;

			for (int c = 0; c < 3; c++) {
				const int place = (patch * (c ? 6 * c + 1 : 1) + 5 * c) % patches;
				const double l = pow(range, (double)place / patches);

				picture->u8[3 * (y * picture->width + x) + c] =
					chart_code(camera, time * l, chance);
			}
		}
	}
}
