/* SPDX-License-Identifier: MIT */
#include "hal/lights/pixel_noise.h"

#include <math.h>

struct pixel_noise pixel_noise_of(const struct transfer_curve *curve)
{
	struct pixel_noise noise = {0, 0};
	double square[255];

	for (int code = 0; code < 255; code++) {
		const double light = transfer_curve_decode(curve, code / 255.0);
		const double step = transfer_curve_decode(curve, (code + 1) / 255.0) - light;

		square[code] = step * PIXEL_NOISE_CODES * step * PIXEL_NOISE_CODES;
		if (light <= 0)
			noise.floor = fmax(noise.floor, square[code]);
	}
	for (int code = 0; code < 255; code++) {
		const double light = transfer_curve_decode(curve, code / 255.0);

		if (light > 0)
			noise.slope = fmax(noise.slope, (square[code] - noise.floor) / light);
	}
	return noise;
}

double pixel_believed(const struct transfer_curve *curve, double code)
{
	const double u = (code - curve->black) / (255 - curve->black);
	const double x = fmin(fmax((PIXEL_WHITE - u) / (PIXEL_WHITE - PIXEL_NEAR), 0), 1);

	return x * x * (3 - 2 * x);
}

void pixel_white_fill(struct pixel_white *white, const struct transfer_curve *curve)
{
	white->code = 255;
	white->light[0] = white->soft[0] = transfer_curve_decode(curve, 0);
	for (int c = 1; c < 256; c++) {
		const double step = (white->light[c] = transfer_curve_decode(curve, c / 255.0)) -
				    white->light[c - 1];
		const double believed = pixel_believed(curve, c - 0.5);

		/* exactly x where everything is believed */
		white->soft[c] = believed < 1 ? white->soft[c - 1] + believed * step
					      : white->light[c];
		if (believed < 1 && c < white->code)
			white->code = c;
	}
}

double pixel_white_soft(const struct pixel_white *white, double light)
{
	int low = 0, high = 255;

	if (!(light < white->light[255]))
		return white->soft[255];
	if (!(light >= white->light[white->code - 1]))
		return light;
	while (high - low > 1) { /* light[low] <= light < light[high] */
		const int middle = (low + high) / 2;

		if (light >= white->light[middle])
			low = middle;
		else
			high = middle;
	}
	return white->soft[low] + (light - white->light[low]) *
					  (white->soft[high] - white->soft[low]) /
					  (white->light[high] - white->light[low]);
}
