/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/observe/plain_light.h"

#include <stdlib.h>

#include "hal/colour/transfer.h"

float *plain_light(const struct image *picture)
{
	const size_t count = (size_t)picture->width * (size_t)picture->height;
	float *light = malloc(count * sizeof(*light));
	double decode[256];

	if (!light)
		return NULL;
	for (int code = 0; code < 256; code++)
		decode[code] = transfer_decode(TRANSFER_SRGB, code / 255.0);
	for (size_t p = 0; p < count; p++) {
		double sum = 0;

		for (size_t c = 0; c < 3; c++)
			sum += picture->u8 ? decode[picture->u8[3 * p + c]]
					   : (double)picture->f32[3 * p + c];
		light[p] = (float)(sum / 3);
	}
	return light;
}
