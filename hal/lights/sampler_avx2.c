/* SPDX-License-Identifier: MIT */
/* AVX2. sampler_decode_c() of the C table decodes the rest of a row. */
#include <immintrin.h>
#include <stddef.h>
#include <string.h>

#include "hal/base/processor.h"
#include "hal/lights/sampler_kernels.h"

enum { PIXELS = 16 };

static inline __m256i avx2_look_up(const int32_t table[256], __m256i pixels, int shift)
{
	const __m256i code = _mm256_and_si256(_mm256_srli_epi32(pixels, shift),
					      _mm256_set1_epi32(255));

	return _mm256_i32gather_epi32(table, code, 4);
}

/* Packs twice eight lanes of 32 bits to sixteen of 16 bits, in order. */
static inline __m256i avx2_narrow(__m256i first, __m256i second)
{
	return _mm256_permute4x64_epi64(_mm256_packs_epi32(first, second), 0xd8);
}

/* -1 in lanes where a channel is white or more. */
static inline __m256i avx2_clipped(__m256i pixels, __m256i white)
{
	const __m256i most = _mm256_max_epu8(pixels, white);
	const __m256i full = _mm256_and_si256(_mm256_cmpeq_epi8(pixels, most),
					      _mm256_set1_epi32(0xffffff));

	return _mm256_xor_si256(_mm256_cmpeq_epi32(full, _mm256_setzero_si256()),
				_mm256_set1_epi32(-1));
}

static bool sampler_decode_avx2(const struct sampler_decode *table, const uint32_t *bgrx, int count,
				int16_t *planes, size_t plane_stride)
{
	const __m256i white = _mm256_set1_epi8((char)table->white);
	__m256i any = _mm256_setzero_si256();

	for (; count >= PIXELS; count -= PIXELS, bgrx += PIXELS, planes += PIXELS) {
		const __m256i a = _mm256_loadu_si256((const void *)bgrx);
		const __m256i b = _mm256_loadu_si256((const void *)(bgrx + 8));
		const __m256i full = avx2_narrow(avx2_clipped(a, white), avx2_clipped(b, white));

		for (int c = 0; c < 3; c++)
			_mm256_storeu_si256((void *)(planes + (size_t)c * plane_stride),
					    avx2_narrow(avx2_look_up(table->wide, a, 16 - 8 * c),
							avx2_look_up(table->wide, b, 16 - 8 * c)));
		_mm256_storeu_si256((void *)(planes + 3 * plane_stride),
				    _mm256_srli_epi16(full, 15));
		any = _mm256_or_si256(any, full);
	}
	return sampler_decode_c(table, bgrx, count, planes, plane_stride) ||
	       !_mm256_testz_si256(any, any);
}

static inline __m256i avx2_widened(__m256i lanes)
{
	return _mm256_add_epi64(_mm256_cvtepi32_epi64(_mm256_castsi256_si128(lanes)),
				_mm256_cvtepi32_epi64(_mm256_extracti128_si256(lanes, 1)));
}

/* Sum of all lanes of 128 * high + low. */
static inline int64_t avx2_flushed(__m256i high, __m256i low)
{
	const __m256i all = _mm256_add_epi64(_mm256_slli_epi64(avx2_widened(high), 7),
					     avx2_widened(low));
	const __m128i half = _mm_add_epi64(_mm256_castsi256_si128(all),
					   _mm256_extracti128_si256(all, 1));

	return _mm_cvtsi128_si64(half) + _mm_extract_epi64(half, 1);
}

/* Adds as many spans as 32-bit sums can hold, SAMPLER_CHUNKS_MAX chunks. Returns their number. */
static inline __attribute__((always_inline)) int
avx2_add_some(const int16_t *planes, int count, size_t plane_stride,
	      const struct sampler_span *spans, int span_count, const uint16_t **weights,
	      int64_t sum[SAMPLER_PLANES])
{
	const __m256i seven = _mm256_set1_epi16(127);
	const uint16_t *weight = *weights;
	__m256i high[4], low[4];
	unsigned chunks = 0;
	int k;

	for (int c = 0; c < count; c++)
		high[c] = low[c] = _mm256_setzero_si256();
	for (k = 0; k < span_count && chunks + spans[k].chunks <= SAMPLER_CHUNKS_MAX; k++) {
		const int16_t *value = planes + spans[k].offset;

		chunks += spans[k].chunks;
		for (unsigned n = 0; n < spans[k].chunks; n++) {
			const __m256i w = _mm256_load_si256((const void *)weight);
			const __m256i h = _mm256_srli_epi16(w, 7), l = _mm256_and_si256(w, seven);

			for (int c = 0; c < count; c++) {
				const __m256i v = _mm256_loadu_si256(
					(const void *)(value + (size_t)c * plane_stride));

				high[c] = _mm256_add_epi32(high[c], _mm256_madd_epi16(v, h));
				low[c] = _mm256_add_epi32(low[c], _mm256_madd_epi16(v, l));
			}
			value += SAMPLER_CHUNK;
			weight += SAMPLER_CHUNK;
		}
	}
	for (int c = 0; c < count; c++)
		sum[c] += avx2_flushed(high[c], low[c]);
	*weights = weight;
	return k;
}

static void sampler_add_avx2(const int16_t *planes, int count, size_t plane_stride,
			     const struct sampler_span *spans, int span_count,
			     const uint16_t *weight, int64_t sum[SAMPLER_PLANES])
{
	memset(sum, 0, SAMPLER_PLANES * sizeof(*sum));
	for (int k = 0; k < span_count;) {
		/* The number of planes is a constant in each call, so that sums stay in
		 * registers. */
		if (count == 3)
			k += avx2_add_some(planes, 3, plane_stride, spans + k, span_count - k,
					   &weight, sum);
		else
			k += avx2_add_some(planes, 4, plane_stride, spans + k, span_count - k,
					   &weight, sum);
	}
}

const struct sampler_kernels sampler_kernels_avx2 = {
	.name = "avx2",
	.needs = PROCESSOR_AVX2,
	.decode = sampler_decode_avx2,
	.add = sampler_add_avx2,
};
