/* SPDX-License-Identifier: MIT */
/* AVX-512 with F, BW, DQ, VL, VBMI and VNNI. */
#include <immintrin.h>
#include <stddef.h>
#include <string.h>

#include "hal/base/processor.h"
#include "hal/lights/sampler_kernels.h"

enum { PIXELS = 64, VALUES = 32 };

/* Weights are prefetched so many values ahead. */
enum { AHEAD = 2048 };

/* A table of 256 bytes in registers. */
struct lookup {
	__m512i quarter[4];
};

static inline struct lookup avx512_load_lookup(const uint8_t table[256])
{
	struct lookup l;

	for (int i = 0; i < 4; i++)
		l.quarter[i] = _mm512_loadu_si512(table + 64 * i);
	return l;
}

static inline __m512i avx512_look_up(const struct lookup *l, __m512i code)
{
	/* Seven bits select among 128 bytes, the eighth selects the half of the table. */
	const __m512i low = _mm512_permutex2var_epi8(l->quarter[0], code, l->quarter[1]);
	const __m512i high = _mm512_permutex2var_epi8(l->quarter[2], code, l->quarter[3]);

	return _mm512_mask_blend_epi8(_mm512_movepi8_mask(code), low, high);
}

/* Byte indices that gather the codes of one channel of 64 pixels such that unpacking bytes to words
 * puts them in order: pixels 8 L.. in the low half of lane L, 32 + 8 L.. in the high half. */
static inline __m512i avx512_gather_order(int channel)
{
	const __m512i lanes = _mm512_setr_epi64(0, 0, 0x2020202020202020, 0x2020202020202020,
						0x4040404040404040, 0x4040404040404040,
						0x6060606060606060, 0x6060606060606060);
	const __m512i within = _mm512_set1_epi64(0x1c1814100c080400);

	return _mm512_add_epi8(_mm512_or_si512(lanes, within), _mm512_set1_epi8((char)channel));
}

static inline __m512i avx512_gather(const __m512i pixels[4], __m512i order)
{
	const __m512i first = _mm512_permutex2var_epi8(pixels[0], order, pixels[1]);
	const __m512i second = _mm512_permutex2var_epi8(pixels[2], order, pixels[3]);

	return _mm512_mask_blend_epi8(0xff00ff00ff00ff00, first, second);
}

/* Unpacks low and high bytes in that order to 64 words and writes those of the mask. */
static inline __attribute__((always_inline)) void avx512_store(int16_t *to, __m512i low,
							       __m512i high, __mmask64 which)
{
	_mm512_mask_storeu_epi16(to, (__mmask32)which, _mm512_unpacklo_epi8(low, high));
	_mm512_mask_storeu_epi16(to + VALUES, (__mmask32)(which >> VALUES),
				 _mm512_unpackhi_epi8(low, high));
}

/* Decodes 64 pixels; those outside the mask count as 0 and are not written. Returns the clipped
 * ones. */
static inline __attribute__((always_inline)) __mmask64
avx512_decode_pixels(const struct lookup *low, const struct lookup *high, const __m512i order[3],
		     const uint32_t *bgrx, int16_t *planes, size_t plane_stride, __m512i white,
		     __mmask64 which)
{
	__m512i pixels[4];
	__mmask64 full = 0;

	for (int i = 0; i < 4; i++)
		pixels[i] = _mm512_maskz_loadu_epi32((__mmask16)(which >> 16 * i), bgrx + 16 * i);
	for (int c = 0; c < 3; c++) {
		const __m512i code = avx512_gather(pixels, order[c]);

		full |= _mm512_cmpge_epu8_mask(code, white);
		avx512_store(planes + (size_t)c * plane_stride, avx512_look_up(low, code),
			     avx512_look_up(high, code), which);
	}
	avx512_store(planes + 3 * plane_stride, _mm512_maskz_set1_epi8(full, 1),
		     _mm512_setzero_si512(), which);
	/* Codes are in the order of the gathering, the mask in that of pixels; pixels outside it
	 * are 0, and white is not. */
	return full;
}

static bool sampler_decode_avx512(const struct sampler_decode *table, const uint32_t *bgrx,
				  int count, int16_t *planes, size_t plane_stride)
{
	const struct lookup low = avx512_load_lookup(table->low),
			    high = avx512_load_lookup(table->high);
	const __m512i order[3] = {avx512_gather_order(2), avx512_gather_order(1),
				  avx512_gather_order(0)};
	const __m512i white = _mm512_set1_epi8((char)table->white);
	__mmask64 any = 0;

	for (; count >= PIXELS; count -= PIXELS, bgrx += PIXELS, planes += PIXELS)
		any |= avx512_decode_pixels(&low, &high, order, bgrx, planes, plane_stride, white,
					    ~0ULL);
	if (count)
		any |= avx512_decode_pixels(&low, &high, order, bgrx, planes, plane_stride, white,
					    (1ULL << count) - 1);
	return any != 0;
}

/* 128 * high + low in eight lanes of 64 bits. */
static inline __m512i avx512_widened(__m512i high, __m512i low)
{
	const __m512i h =
		_mm512_add_epi64(_mm512_cvtepi32_epi64(_mm512_castsi512_si256(high)),
				 _mm512_cvtepi32_epi64(_mm512_extracti64x4_epi64(high, 1)));
	const __m512i l =
		_mm512_add_epi64(_mm512_cvtepi32_epi64(_mm512_castsi512_si256(low)),
				 _mm512_cvtepi32_epi64(_mm512_extracti64x4_epi64(low, 1)));

	return _mm512_add_epi64(_mm512_slli_epi64(h, 7), l);
}

static inline __m512i avx512_add_pairs(__m512i a, __m512i b)
{
	return _mm512_add_epi64(_mm512_unpacklo_epi64(a, b), _mm512_unpackhi_epi64(a, b));
}

/* Adds all lanes of each of the four planes' 128 * high + low to sum. */
static inline void avx512_flush(const __m512i high[4], const __m512i low[4],
				int64_t sum[SAMPLER_PLANES])
{
	/* lanes of 128 bits: 0 1, and 2 3 */
	const __m512i rg = avx512_add_pairs(avx512_widened(high[0], low[0]),
					    avx512_widened(high[1], low[1]));
	const __m512i bc = avx512_add_pairs(avx512_widened(high[2], low[2]),
					    avx512_widened(high[3], low[3]));
	const __m512i even = _mm512_shuffle_i64x2(rg, bc, 0x88); /* rg0 rg2 bc0 bc2 */
	const __m512i odd = _mm512_shuffle_i64x2(rg, bc, 0xdd);
	const __m512i both = _mm512_add_epi64(even, odd);
	const __m512i all = _mm512_add_epi64(both, _mm512_shuffle_i64x2(both, both, 0xb1));
	const __m256i four = _mm512_castsi512_si256(
		_mm512_permutexvar_epi64(_mm512_setr_epi64(0, 1, 4, 5, 0, 1, 4, 5), all));

	_mm256_storeu_si256((void *)sum,
			    _mm256_add_epi64(four, _mm256_loadu_si256((const void *)sum)));
}

/* Adds as many spans as 32-bit sums can hold, SAMPLER_CHUNKS_MAX chunks. Returns their number. */
static inline __attribute__((always_inline)) int
avx512_add_some(const int16_t *planes, int count, size_t plane_stride,
		const struct sampler_span *spans, int span_count, const uint16_t **weights,
		int64_t sum[SAMPLER_PLANES])
{
	const __m512i seven = _mm512_set1_epi16(127);
	const uint16_t *weight = *weights;
	__m512i high[4], low[4];
	unsigned chunks = 0;
	int k;

	for (int c = 0; c < 4; c++)
		high[c] = low[c] = _mm512_setzero_si512();
	for (k = 0; k < span_count && chunks + spans[k].chunks <= SAMPLER_CHUNKS_MAX; k++) {
		const int16_t *value = planes + spans[k].offset;
		unsigned left = spans[k].chunks;

		chunks += left;
		_mm_prefetch((const char *)(weight + AHEAD), _MM_HINT_T0);
		_mm_prefetch((const char *)(weight + AHEAD + VALUES), _MM_HINT_T0);
		for (; left >= 2; left -= 2, value += VALUES, weight += VALUES) {
			const __m512i w = _mm512_loadu_si512(weight);
			const __m512i h = _mm512_srli_epi16(w, 7), l = _mm512_and_si512(w, seven);

			for (int c = 0; c < count; c++) {
				const __m512i v =
					_mm512_loadu_si512(value + (size_t)c * plane_stride);

				high[c] = _mm512_dpwssd_epi32(high[c], v, h);
				low[c] = _mm512_dpwssd_epi32(low[c], v, l);
			}
		}
		if (left) { /* half of a vector */
			const __m512i w =
				_mm512_zextsi256_si512(_mm256_load_si256((const void *)weight));
			const __m512i h = _mm512_srli_epi16(w, 7), l = _mm512_and_si512(w, seven);

			weight += SAMPLER_CHUNK;
			for (int c = 0; c < count; c++) {
				const __m512i v = _mm512_zextsi256_si512(_mm256_loadu_si256(
					(const void *)(value + (size_t)c * plane_stride)));

				high[c] = _mm512_dpwssd_epi32(high[c], v, h);
				low[c] = _mm512_dpwssd_epi32(low[c], v, l);
			}
		}
	}
	avx512_flush(high, low, sum);
	*weights = weight;
	return k;
}

static void sampler_add_avx512(const int16_t *planes, int count, size_t plane_stride,
			       const struct sampler_span *spans, int span_count,
			       const uint16_t *weight, int64_t sum[SAMPLER_PLANES])
{
	memset(sum, 0, SAMPLER_PLANES * sizeof(*sum));
	for (int k = 0; k < span_count;) {
		/* The number of planes is a constant in each call, so that sums stay in
		 * registers. */
		if (count == 3)
			k += avx512_add_some(planes, 3, plane_stride, spans + k, span_count - k,
					     &weight, sum);
		else
			k += avx512_add_some(planes, 4, plane_stride, spans + k, span_count - k,
					     &weight, sum);
	}
}

const struct sampler_kernels sampler_kernels_avx512 = {
	.name = "avx512",
	.needs = PROCESSOR_AVX512 | PROCESSOR_AVX512_VBMI | PROCESSOR_AVX512_VNNI,
	.decode = sampler_decode_avx512,
	.add = sampler_add_avx512,
};
