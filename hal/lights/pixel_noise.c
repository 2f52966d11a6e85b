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
