/* SPDX-License-Identifier: MIT */
#include "bake/tiles/peaks.h"

#include <math.h>
#include <stddef.h>

void peaks_grow(float (*peak)[3], const struct encode_samples *samples, int lights)
{
	const size_t count = (size_t)lights;

	if (samples->kind != BASIS_KIND_T)
		return;
	for (size_t row = 0; row < 3 * (size_t)samples->pixels; row++) {
		const float *direct = samples->direct + row * count;
		const float *bounce = samples->bounce ? samples->bounce + row * count : NULL;
		const size_t c = row % 3;
		float sum = 0;

		for (size_t i = 0; i < count; i++) {
			const float value = direct[i] + (bounce ? bounce[i] : 0);

			peak[i][c] = fmaxf(peak[i][c], value);
			sum += value;
		}
		peak[count][c] = fmaxf(peak[count][c], sum);
	}
}

void peaks_join(float (*peak)[3], const float (*other)[3], int lights)
{
	for (int i = 0; i <= lights; i++)
		for (int c = 0; c < 3; c++)
			peak[i][c] = fmaxf(peak[i][c], other[i][c]);
}
