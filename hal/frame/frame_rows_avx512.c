/* SPDX-License-Identifier: MIT */
/* AVX-512 F, BW, DQ and VL: 16 pixels at a time, the rest of a row under a mask. */
#include <immintrin.h>

#include "hal/base/processor.h"
#include "hal/frame/frame_rows.h"

enum { PIXELS = 16 };

struct avx512_ycbcr {
	__m512 y_scale, y_offset, to_blue_red, to_green;
};

/* Chroma coefficients in alternate lanes, as Cb and Cr alternate. */
static inline __m512 avx512_alternate(float even, float odd)
{
	return _mm512_mask_blend_ps(0xaaaa, _mm512_set1_ps(even), _mm512_set1_ps(odd));
}

static inline struct avx512_ycbcr avx512_widen(const struct ycbcr *k)
{
	return (struct avx512_ycbcr){
		.y_scale = _mm512_set1_ps(k->y_scale),
		.y_offset = _mm512_set1_ps(k->y_offset),
		.to_blue_red = avx512_alternate(k->b_cb, k->r_cr),
		.to_green = avx512_alternate(k->g_cb, k->g_cr),
	};
}

/* Packs 32-bit channels to BGRX. Packing saturates to 0..255, and truncation has made values in
 * (-1, 0) zero: the same result as clamping before truncation. */
static inline __m512i avx512_interleave(__m512i b, __m512i g, __m512i r)
{
	/* each lane of 128 bits: b0-3 r0-3, g0-3 x0-3, then b0-3 r0-3 g0-3 x0-3 */
	const __m512i br = _mm512_packs_epi32(b, r);
	const __m512i gx = _mm512_packs_epi32(g, _mm512_set1_epi32(255));
	const __m512i order = _mm512_broadcast_i32x4(
		_mm_setr_epi8(0, 8, 4, 12, 1, 9, 5, 13, 2, 10, 6, 14, 3, 11, 7, 15));

	return _mm512_shuffle_epi8(_mm512_packus_epi16(br, gx), order);
}

/* y: one value per lane; chroma: Cb and Cr of a pair in its two lanes. */
static inline __m512i avx512_convert(const struct avx512_ycbcr *k, __m512i y, __m512i chroma)
{
	const __m512 luma = _mm512_add_ps(_mm512_mul_ps(k->y_scale, _mm512_cvtepi32_ps(y)),
					  k->y_offset);
	const __m512 c = _mm512_sub_ps(_mm512_cvtepi32_ps(chroma), _mm512_set1_ps(128));
	const __m512 blue_red = _mm512_mul_ps(k->to_blue_red, c);
	const __m512 green = _mm512_mul_ps(k->to_green, c);
	/* Swap neighbours and add: both lanes of a pair get Cb + Cr terms; addition commutes. */
	const __m512 g = _mm512_add_ps(green, _mm512_permute_ps(green, 0xb1));

	return avx512_interleave(
		_mm512_cvttps_epi32(_mm512_add_ps(luma, _mm512_moveldup_ps(blue_red))),
		_mm512_cvttps_epi32(_mm512_add_ps(luma, g)),
		_mm512_cvttps_epi32(_mm512_add_ps(luma, _mm512_movehdup_ps(blue_red))));
}

static inline __m512i avx512_low_bytes(__m512i words)
{
	return _mm512_and_si512(words, _mm512_set1_epi32(255));
}

static inline __m512i avx512_yuyv16(const struct avx512_ycbcr *k, __m256i packed)
{
	const __m512i words = _mm512_cvtepu16_epi32(packed); /* Y low, chroma high */

	return avx512_convert(k, avx512_low_bytes(words), _mm512_srli_epi32(words, 8));
}

static inline __m512i avx512_uyvy16(const struct avx512_ycbcr *k, __m256i packed)
{
	const __m512i words = _mm512_cvtepu16_epi32(packed);

	return avx512_convert(k, _mm512_srli_epi32(words, 8), avx512_low_bytes(words));
}

static inline __mmask16 first_lanes(int count)
{
	return (__mmask16)((1U << count) - 1);
}

/* Lanes of whole pairs: a last pixel without a partner needs the chroma of a pair. */
static inline __mmask16 pair_lanes(int count)
{
	return first_lanes((count + 1) & ~1);
}

static void avx512_yuyv(const struct ycbcr *k, const uint8_t *from, int count, uint32_t *bgrx)
{
	const struct avx512_ycbcr w = avx512_widen(k);

	for (; count >= PIXELS; count -= PIXELS, from += 2 * PIXELS, bgrx += PIXELS)
		_mm512_storeu_si512(bgrx,
				    avx512_yuyv16(&w, _mm256_loadu_si256((const void *)from)));
	if (count)
		_mm512_mask_storeu_epi32(
			bgrx, first_lanes(count),
			avx512_yuyv16(&w, _mm256_maskz_loadu_epi16(pair_lanes(count), from)));
}

static void avx512_uyvy(const struct ycbcr *k, const uint8_t *from, int count, uint32_t *bgrx)
{
	const struct avx512_ycbcr w = avx512_widen(k);

	for (; count >= PIXELS; count -= PIXELS, from += 2 * PIXELS, bgrx += PIXELS)
		_mm512_storeu_si512(bgrx,
				    avx512_uyvy16(&w, _mm256_loadu_si256((const void *)from)));
	if (count)
		_mm512_mask_storeu_epi32(
			bgrx, first_lanes(count),
			avx512_uyvy16(&w, _mm256_maskz_loadu_epi16(pair_lanes(count), from)));
}

static void avx512_nv12(const struct ycbcr *k, const uint8_t *y, const uint8_t *cbcr, int count,
			uint32_t *bgrx)
{
	const struct avx512_ycbcr w = avx512_widen(k);

	for (; count >= PIXELS; count -= PIXELS, y += PIXELS, cbcr += PIXELS, bgrx += PIXELS)
		_mm512_storeu_si512(
			bgrx,
			avx512_convert(&w, _mm512_cvtepu8_epi32(_mm_loadu_si128((const void *)y)),
				       _mm512_cvtepu8_epi32(_mm_loadu_si128((const void *)cbcr))));
	if (count) {
		const __m128i luma = _mm_maskz_loadu_epi8(first_lanes(count), y);
		const __m128i chroma = _mm_maskz_loadu_epi8(pair_lanes(count), cbcr);

		_mm512_mask_storeu_epi32(bgrx, first_lanes(count),
					 avx512_convert(&w, _mm512_cvtepu8_epi32(luma),
							_mm512_cvtepu8_epi32(chroma)));
	}
}

static inline __m512i avx512_grey16(const struct avx512_ycbcr *k, __m128i y)
{
	const __m512i code = _mm512_cvttps_epi32(_mm512_add_ps(
		_mm512_mul_ps(k->y_scale, _mm512_cvtepi32_ps(_mm512_cvtepu8_epi32(y))),
		k->y_offset));

	return avx512_interleave(code, code, code);
}

static void avx512_grey(const struct ycbcr *k, const uint8_t *y, int count, uint32_t *bgrx)
{
	const struct avx512_ycbcr w = avx512_widen(k);

	for (; count >= PIXELS; count -= PIXELS, y += PIXELS, bgrx += PIXELS)
		_mm512_storeu_si512(bgrx, avx512_grey16(&w, _mm_loadu_si128((const void *)y)));
	if (count)
		_mm512_mask_storeu_epi32(
			bgrx, first_lanes(count),
			avx512_grey16(&w, _mm_maskz_loadu_epi8(first_lanes(count), y)));
}

/* Swaps vectors from both ends towards the middle. */
static void avx512_reverse(uint32_t *bgrx, int count)
{
	const __m512i order = _mm512_setr_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1,
						0);
	uint32_t *end = bgrx + count;

	for (; count >= 2 * PIXELS; count -= 2 * PIXELS, bgrx += PIXELS) {
		const __m512i left = _mm512_loadu_si512(bgrx);
		const __m512i right = _mm512_loadu_si512(end - PIXELS);

		end -= PIXELS;
		_mm512_storeu_si512(end, _mm512_permutexvar_epi32(order, left));
		_mm512_storeu_si512(bgrx, _mm512_permutexvar_epi32(order, right));
	}
	bgrx_row_reverse(bgrx, count);
}

const struct frame_rows frame_rows_avx512 = {
	.name = "avx512",
	.needs = PROCESSOR_AVX512,
	.yuyv = avx512_yuyv,
	.uyvy = avx512_uyvy,
	.nv12 = avx512_nv12,
	.grey = avx512_grey,
	.reverse = avx512_reverse,
};
