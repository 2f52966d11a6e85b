/* SPDX-License-Identifier: MIT */
#include "hal/compositor/kernels/digits.h"
#include "hal/compositor/kernels/kernels_isa.h"

#include <immintrin.h>

#include "hal/compositor/kernels/kernels_avx512_mix.h"
#include "hal/compositor/kernels/kernels_avx512_sums.h"
#include "hal/compositor/kernels/kernels_grain.h"

/* ---- split ---- */

/* Two weights: lanes of int64 are channels 0 1 2 -, 0 1 2 -. */
static inline __m512i avx512_two_of(int64_t (*weight)[KERNEL_WEIGHT])
{
	return _mm512_maskz_loadu_epi64(0x77, weight);
}

static int avx512_digits_needed(int64_t (*weight)[KERNEL_WEIGHT], int count)
{
	__m512i most = _mm512_setzero_si512();

	for (int k = 0; k < count; k += 2)
		most = _mm512_max_epi64(most, _mm512_abs_epi64(avx512_two_of(weight + k)));
	return digits_of(_mm512_reduce_max_epi64(most));
}

/* The four digits of each int64, as its four int16. */
static inline __m512i avx512_digits_apart(__m512i x)
{
	const __m512i biased = _mm512_add_epi64(x, _mm512_set1_epi64(DIGITS_BIAS));
	__m512i y = _mm512_and_si512(biased, _mm512_set1_epi64(4095));

	KERNEL_UNROLL
	for (int d = 1; d < KERNEL_DIGITS; d++) {
		const __m512i there = _mm512_slli_epi64(biased, (16 - KERNEL_DIGIT_BITS) * d);

		y = _mm512_or_si512(
			y, _mm512_and_si512(there, _mm512_set1_epi64(INT64_C(4095) << 16 * d)));
	}
	return _mm512_sub_epi16(y, _mm512_set1_epi16(DIGIT_HALF));
}

static int avx512_split(int64_t (*weight)[KERNEL_WEIGHT], int count, int16_t *digit)
{
	/* [channel][digit][weight] of [weight][channel][digit], for each number of digits */
	static const int16_t from[KERNEL_DIGITS + 1][32] = {
		{0},
		{0, 16, 4, 20, 8, 24},
		{0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25},
		{0, 16, 1, 17, 2, 18, 4, 20, 5, 21, 6, 22, 8, 24, 9, 25, 10, 26},
		{0, 16, 1, 17, 2, 18, 3, 19, 4,	 20, 5,	 21,
		 6, 22, 7, 23, 8, 24, 9, 25, 10, 26, 11, 27},
	};
	const int digits = avx512_digits_needed(weight, count), step = 2 * 3 * digits;
	const __mmask32 stored = (__mmask32)((UINT64_C(1) << step) - 1);
	const __m512i order = _mm512_loadu_si512(from[digits]);

	for (int k = 0; k < count && digits; k += 2, digit += step)
		_mm512_mask_storeu_epi16(
			digit, stored,
			_mm512_permutexvar_epi16(order,
						 avx512_digits_apart(avx512_two_of(weight + k))));
	return digits;
}

/* ---- project ---- */

/* Values of a row until each lane of int32 holds 32 products. */
#define ROW_RUN (16 * KERNEL_LANE_PRODUCTS)

/* Adds the products of a run of one row with all planes to total[channel], in int64. */
KERNEL_INLINE void avx512_row_run(const int16_t *row, const struct kernel_planes *p, int from,
				  int to, const int digits, __m512i total[3])
{
	__m512i part[3][KERNEL_DIGITS];

	KERNEL_UNROLL
	for (int c = 0; c < 3; c++) {
		KERNEL_UNROLL
		for (int d = 0; d < digits; d++)
			part[c][d] = _mm512_setzero_si512();
	}
	for (int k = from; k < to; k += 32) {
		const __m512i x = _mm512_load_si512(row + k);

		KERNEL_UNROLL
		for (int c = 0; c < 3; c++) {
			KERNEL_UNROLL
			for (int d = 0; d < digits; d++) {
				part[c][d] = _mm512_dpwssd_epi32(
					part[c][d], x, _mm512_load_si512(p->plane[c][d] + k));
				/* Keeps gcc 12 from copying between two sets of sums. */
				__asm__("" : "+v"(part[c][d]));
			}
		}
	}
	KERNEL_UNROLL
	for (int c = 0; c < 3; c++) {
		__m512i sum = _mm512_setzero_si512();

		KERNEL_UNROLL
		for (int d = digits - 1; d >= 0; d--) {
			/* Even and odd lanes of int32. */
			const __m512i even = _mm512_mul_epi32(part[c][d], _mm512_set1_epi64(1));
			const __m512i odd = _mm512_srai_epi64(part[c][d], 32);

			sum = _mm512_add_epi64(_mm512_slli_epi64(sum, KERNEL_DIGIT_BITS),
					       _mm512_add_epi64(odd, even));
		}
		total[c] = _mm512_add_epi64(total[c], sum);
	}
}

/* Stores the sum over the lanes of each channel to y. */
static inline void avx512_store_lanes(int64_t *y, const __m512i total[3])
{
	__m256i half[3], pair, last;
	__m128i two;

	KERNEL_UNROLL
	for (int c = 0; c < 3; c++)
		half[c] = _mm256_add_epi64(_mm512_castsi512_si256(total[c]),
					   _mm512_extracti64x4_epi64(total[c], 1));
	pair = _mm256_add_epi64(_mm256_unpacklo_epi64(half[0], half[1]),
				_mm256_unpackhi_epi64(half[0], half[1]));
	last = _mm256_add_epi64(half[2], _mm256_unpackhi_epi64(half[2], half[2]));
	two = _mm_add_epi64(_mm256_castsi256_si128(pair), _mm256_extracti128_si256(pair, 1));
	_mm_storeu_si128((__m128i *)y, two);
	two = _mm_add_epi64(_mm256_castsi256_si128(last), _mm256_extracti128_si256(last, 1));
	y[2] = _mm_cvtsi128_si64(two);
}

KERNEL_INLINE void avx512_project_of(const int16_t *rows, int count, int stride,
				     const struct kernel_planes *planes, int64_t (*y)[3],
				     const int digits)
{
	for (int j = 0; j < count; j++, rows += stride) {
		__m512i total[3];

		total[0] = total[1] = total[2] = _mm512_setzero_si512();
		for (int k = 0; k < stride; k += ROW_RUN) {
			const int end = stride - k > ROW_RUN ? k + ROW_RUN : stride;

			avx512_row_run(rows, planes, k, end, digits, total);
		}
		avx512_store_lanes(y[j], total);
	}
}

static void avx512_project(const int16_t *rows, int count, int stride,
			   const struct kernel_vector vector[3], int64_t (*y)[3])
{
	struct kernel_planes planes;

	kernel_planes_fill(&planes, vector);
	switch (planes.digits) {
	case 0:
		memset(y, 0, (size_t)count * sizeof(*y));
		break;
	case 1:
		avx512_project_of(rows, count, stride, &planes, y, 1);
		break;
	case 2:
		avx512_project_of(rows, count, stride, &planes, y, 2);
		break;
	case 3:
		avx512_project_of(rows, count, stride, &planes, y, 3);
		break;
	default:
		avx512_project_of(rows, count, stride, &planes, y, 4);
		break;
	}
}

/* ---- fold ---- */

KERNEL_INLINE __m512i avx512_limit64(__m512i x)
{
	return _mm512_max_epi64(_mm512_min_epi64(x, _mm512_set1_epi64(KERNEL_LIMIT)),
				_mm512_set1_epi64(-(int64_t)KERNEL_LIMIT));
}

KERNEL_INLINE __m512i avx512_rounded(__m512i x, __m512i half, __m128i bits)
{
	return _mm512_sra_epi64(_mm512_add_epi64(x, half), bits);
}

/* Factors and tints up to 1, as most are, need no clamp: the result is not larger than x. */
KERNEL_INLINE __m512i avx512_tinted(__m512i x, const uint16_t *tint, __mmask8 mask)
{
	const __m512i t = _mm512_cvtepu16_epi64(_mm_maskz_loadu_epi16(mask, tint));

	x = avx512_rounded(_mm512_mul_epi32(x, t), _mm512_set1_epi64(1 << 14),
			   _mm_cvtsi32_si128(15));
	return _mm512_cmpgt_epi64_mask(t, _mm512_set1_epi64(1 << 15)) ? avx512_limit64(x) : x;
}

static void avx512_fold(const int64_t *sum, int count, int shift, uint32_t factor,
			const uint16_t *tint, const int32_t *from, int32_t *to)
{
	/* The multiplication is signed, and 2^31 does not fit: halve the factor, shift one bit
	 * less. */
	const int whole = factor >> 31 ? 29 : 30;
	const __m512i f = _mm512_set1_epi64(factor >> (30 - whole));
	const __m512i half1 = _mm512_set1_epi64(INT64_C(1) << (shift - 1));
	const __m512i half2 = _mm512_set1_epi64(INT64_C(1) << (whole - 1));
	const __m128i bits1 = _mm_cvtsi32_si128(shift), bits2 = _mm_cvtsi32_si128(whole);

	for (int p = 0; p < count; p += 8) {
		const __mmask8 mask = (__mmask8)(count - p >= 8 ? 0xff : (1 << (count - p)) - 1);
		const __m512i all = _mm512_maskz_loadu_epi64(mask, sum + p);
		__m512i x = avx512_limit64(avx512_rounded(all, half1, bits1));

		if (factor != 1U << 30)
			x = avx512_rounded(_mm512_mul_epi32(x, f), half2, bits2);
		if (factor > 1U << 30)
			x = avx512_limit64(x);
		if (tint)
			x = avx512_tinted(x, tint + p, mask);
		x = _mm512_add_epi64(
			x, _mm512_cvtepi32_epi64(_mm256_maskz_loadu_epi32(mask, from + p)));
		_mm256_mask_storeu_epi32(to + p, mask, _mm512_cvtepi64_epi32(avx512_limit64(x)));
	}
}

/* ---- tint, place ---- */

static void avx512_tint(int32_t *value, const uint16_t *by, int count)
{
	const __m512i half = _mm512_set1_epi32(1 << 14), low = _mm512_set1_epi32((1 << 15) - 1);

	for (int n = 0; n < count; n += 16) {
		const __mmask16 mask = (__mmask16)(count - n >= 16 ? 0xffff
								   : (1 << (count - n)) - 1);
		const __m512i x = _mm512_maskz_loadu_epi32(mask, value + n);
		const __m512i m = _mm512_cvtepu16_epi32(_mm256_maskz_loadu_epi16(mask, by + n));
		/* x = 2^15 h + l, as mul_q15() has it */
		const __m512i of_h = _mm512_mullo_epi32(_mm512_srai_epi32(x, 15), m);
		const __m512i of_l = _mm512_mullo_epi32(_mm512_and_si512(x, low), m);

		_mm512_mask_storeu_epi32(
			value + n, mask,
			_mm512_add_epi32(of_h,
					 _mm512_srli_epi32(_mm512_add_epi32(of_l, half), 15)));
	}
}

static void avx512_place(const int32_t *value, const uint16_t row[16], int32_t *to)
{
	const __m512i zero = _mm512_setzero_si512(), limit = _mm512_set1_epi32(KERNEL_LIMIT);

	for (int y = 0; y < 16; y++, to += 16) {
		const __m512i spread = _mm512_maskz_expand_epi32(row[y], _mm512_loadu_si512(value));
		const __m512i x = _mm512_loadu_si512(to);
		/* Distance to the limits above and below, so that no sum wraps. */
		const __m512i above = _mm512_sub_epi32(limit, _mm512_max_epi32(x, zero));
		const __m512i below = _mm512_sub_epi32(_mm512_sub_epi32(zero, limit),
						       _mm512_min_epi32(x, zero));
		const __m512i more = _mm512_max_epi32(_mm512_min_epi32(spread, above), below);

		_mm512_mask_storeu_epi32(to, row[y], _mm512_add_epi32(x, more));
		value += __builtin_popcount(row[y]);
	}
}

const struct kernels kernels_avx512 = {
	.name = "avx512-vnni",
	.supported = kernels_supported_avx512,
	.sums16 = avx512_sums16,
	.sums8 = avx512_sums8,
	.values16 = avx512_values16,
	.values8 = avx512_values8,
	.split = avx512_split,
	.project = avx512_project,
	.fold = avx512_fold,
	.tint = avx512_tint,
	.place = avx512_place,
	.mix = avx512_mix,
	.grain = kernel_add_grain,
	.divide = kernel_divide,
};
