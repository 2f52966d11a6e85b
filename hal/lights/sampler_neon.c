/* SPDX-License-Identifier: MIT */
/* NEON of aarch64. Decoding is the C table's: a table of 256 does not fit into the registers. */
#include <arm_neon.h>
#include <stddef.h>

#include "hal/base/processor.h"
#include "hal/lights/sampler_kernels.h"

/* Adds products, at most 2^30, in pairs to 64 bits: no sum can overflow. */
static inline int64x2_t neon_add8(int64x2_t sum, int16x8_t value, int16x8_t weight)
{
	sum = vpadalq_s32(sum, vmull_s16(vget_low_s16(value), vget_low_s16(weight)));
	return vpadalq_s32(sum, vmull_high_s16(value, weight));
}

static inline __attribute__((always_inline)) void
neon_add_planes(const int16_t *planes, int count, size_t plane_stride,
		const struct sampler_span *spans, int span_count, const uint16_t *weight,
		int64_t sum[SAMPLER_PLANES])
{
	int64x2_t s[SAMPLER_PLANES];

	for (int c = 0; c < SAMPLER_PLANES; c++)
		s[c] = vdupq_n_s64(0);
	for (int k = 0; k < span_count; k++) {
		const int16_t *value = planes + spans[k].offset;

		for (unsigned n = 0; n < spans[k].chunks * (SAMPLER_CHUNK / 8); n++) {
			const int16x8_t w = vreinterpretq_s16_u16(vld1q_u16(weight));

			for (int c = 0; c < count; c++)
				s[c] = neon_add8(s[c], vld1q_s16(value + (size_t)c * plane_stride),
						 w);
			value += 8;
			weight += 8;
		}
	}
	for (int c = 0; c < SAMPLER_PLANES; c++)
		sum[c] = vaddvq_s64(s[c]);
}

static void sampler_add_neon(const int16_t *planes, int count, size_t plane_stride,
			     const struct sampler_span *spans, int span_count,
			     const uint16_t *weight, int64_t sum[SAMPLER_PLANES])
{
	/* The number of planes is a constant in each call, so that sums stay in registers. */
	if (count == 3)
		neon_add_planes(planes, 3, plane_stride, spans, span_count, weight, sum);
	else
		neon_add_planes(planes, 4, plane_stride, spans, span_count, weight, sum);
}

const struct sampler_kernels sampler_kernels_neon = {
	.name = "neon",
	.needs = PROCESSOR_NEON,
	.decode = sampler_decode_c, /* borrowed from sampler_kernels_c */
	.add = sampler_add_neon,
};
