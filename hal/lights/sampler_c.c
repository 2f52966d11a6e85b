/* SPDX-License-Identifier: MIT */
/* The C kernels of the light sampler: the specification of sampler_kernels.h. */
#include <stddef.h>

#include "hal/lights/sampler_kernels.h"

bool sampler_decode_c(const struct sampler_decode *table, const uint32_t *bgrx, int count,
		      int16_t *planes, size_t plane_stride)
{
	const int16_t *value = table->value;
	const uint32_t white = table->white;
	int16_t *red = planes, *green = red + plane_stride, *blue = green + plane_stride;
	int16_t *clipped = blue + plane_stride;
	bool any = false;

	for (int i = 0; i < count; i++) {
		const uint32_t b = bgrx[i] & 255, g = bgrx[i] >> 8 & 255, r = bgrx[i] >> 16 & 255;

		red[i] = value[r];
		green[i] = value[g];
		blue[i] = value[b];
		clipped[i] = (r >= white) | (g >= white) | (b >= white);
		any |= clipped[i];
	}
	return any;
}

static void sampler_add_c(const int16_t *planes, int plane_count, size_t plane_stride,
			  const struct sampler_span *spans, int span_count, const uint16_t *weight,
			  int64_t sum[SAMPLER_PLANES])
{
	for (int c = 0; c < SAMPLER_PLANES; c++)
		sum[c] = 0;
	for (int k = 0; k < span_count; k++) {
		const int values = (int)spans[k].chunks * SAMPLER_CHUNK;

		for (int c = 0; c < plane_count; c++) {
			const int16_t *plane = planes + (size_t)c * plane_stride + spans[k].offset;
			int64_t s = 0;

			for (int i = 0; i < values; i++)
				s += (int32_t)plane[i] * (int32_t)weight[i];
			sum[c] += s;
		}
		weight += values;
	}
}

const struct sampler_kernels sampler_kernels_c = {
	.name = "c",
	.decode = sampler_decode_c,
	.add = sampler_add_c,
};
