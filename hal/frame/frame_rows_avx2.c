/* SPDX-License-Identifier: MIT */
/* AVX2: eight pixels at a time; the C functions of frame_ycbcr.h convert the rest of a row. */
#include <immintrin.h>

#include "hal/base/processor.h"
#include "hal/frame/frame_rows.h"

enum { PIXELS = 8 };

struct avx2_ycbcr {
	__m256 y_scale, y_offset, to_blue_red, to_green;
};

/* Chroma coefficients in alternate lanes, as Cb and Cr alternate. */
static inline __m256 avx2_alternate(float even, float odd)
{
	return _mm256_blend_ps(_mm256_set1_ps(even), _mm256_set1_ps(odd), 0xaa);
}

static inline struct avx2_ycbcr avx2_widen(const struct ycbcr *k)
{
	return (struct avx2_ycbcr){
		.y_scale = _mm256_set1_ps(k->y_scale),
		.y_offset = _mm256_set1_ps(k->y_offset),
		.to_blue_red = avx2_alternate(k->b_cb, k->r_cr),
		.to_green = avx2_alternate(k->g_cb, k->g_cr),
	};
}

/* Packs 32-bit channels to BGRX. Packing saturates to 0..255, and truncation has made values in
 * (-1, 0) zero: the same result as clamping before truncation. */
static inline __m256i avx2_interleave(__m256i b, __m256i g, __m256i r)
{
	/* each lane of 128 bits: b0-3 r0-3, g0-3 x0-3, then b0-3 r0-3 g0-3 x0-3 */
	const __m256i br = _mm256_packs_epi32(b, r);
	const __m256i gx = _mm256_packs_epi32(g, _mm256_set1_epi32(255));
	const __m256i order = _mm256_broadcastsi128_si256(
		_mm_setr_epi8(0, 8, 4, 12, 1, 9, 5, 13, 2, 10, 6, 14, 3, 11, 7, 15));

	return _mm256_shuffle_epi8(_mm256_packus_epi16(br, gx), order);
}

static inline __m256 avx2_luma(const struct avx2_ycbcr *k, __m256i y)
{
	return _mm256_add_ps(_mm256_mul_ps(k->y_scale, _mm256_cvtepi32_ps(y)), k->y_offset);
}

/* y: one value per lane; chroma: Cb and Cr of a pair in its two lanes. */
static inline __m256i avx2_convert(const struct avx2_ycbcr *k, __m256i y, __m256i chroma)
{
	const __m256 luma = avx2_luma(k, y);
	const __m256 c = _mm256_sub_ps(_mm256_cvtepi32_ps(chroma), _mm256_set1_ps(128));
	const __m256 blue_red = _mm256_mul_ps(k->to_blue_red, c);
	const __m256 green = _mm256_mul_ps(k->to_green, c);
	/* Swap neighbours and add: both lanes of a pair get Cb + Cr terms; addition commutes. */
	const __m256 g = _mm256_add_ps(green, _mm256_permute_ps(green, 0xb1));

	return avx2_interleave(
		_mm256_cvttps_epi32(_mm256_add_ps(luma, _mm256_moveldup_ps(blue_red))),
		_mm256_cvttps_epi32(_mm256_add_ps(luma, g)),
		_mm256_cvttps_epi32(_mm256_add_ps(luma, _mm256_movehdup_ps(blue_red))));
}

static inline __m256i avx2_words_at(const uint8_t *from)
{
	return _mm256_cvtepu16_epi32(_mm_loadu_si128((const void *)from));
}

static inline __m256i avx2_bytes_at(const uint8_t *from)
{
	return _mm256_cvtepu8_epi32(_mm_loadl_epi64((const void *)from));
}

static inline __m256i avx2_low_bytes(__m256i words)
{
	return _mm256_and_si256(words, _mm256_set1_epi32(255));
}

static inline void avx2_store(uint32_t *bgrx, __m256i pixels)
{
	_mm256_storeu_si256((void *)bgrx, pixels);
}

static void avx2_yuyv(const struct ycbcr *k, const uint8_t *from, int count, uint32_t *bgrx)
{
	const struct avx2_ycbcr w = avx2_widen(k);

	for (; count >= PIXELS; count -= PIXELS, from += 2 * PIXELS, bgrx += PIXELS) {
		const __m256i words = avx2_words_at(from); /* Y low, chroma high */

		avx2_store(bgrx,
			   avx2_convert(&w, avx2_low_bytes(words), _mm256_srli_epi32(words, 8)));
	}
	ycbcr_row_yuyv(k, from, count, bgrx);
}

static void avx2_uyvy(const struct ycbcr *k, const uint8_t *from, int count, uint32_t *bgrx)
{
	const struct avx2_ycbcr w = avx2_widen(k);

	for (; count >= PIXELS; count -= PIXELS, from += 2 * PIXELS, bgrx += PIXELS) {
		const __m256i words = avx2_words_at(from);

		avx2_store(bgrx,
			   avx2_convert(&w, _mm256_srli_epi32(words, 8), avx2_low_bytes(words)));
	}
	ycbcr_row_uyvy(k, from, count, bgrx);
}

static void avx2_nv12(const struct ycbcr *k, const uint8_t *y, const uint8_t *cbcr, int count,
		      uint32_t *bgrx)
{
	const struct avx2_ycbcr w = avx2_widen(k);

	for (; count >= PIXELS; count -= PIXELS, y += PIXELS, cbcr += PIXELS, bgrx += PIXELS)
		avx2_store(bgrx, avx2_convert(&w, avx2_bytes_at(y), avx2_bytes_at(cbcr)));
	ycbcr_row_nv12(k, y, cbcr, count, bgrx);
}

static void avx2_grey(const struct ycbcr *k, const uint8_t *y, int count, uint32_t *bgrx)
{
	const struct avx2_ycbcr w = avx2_widen(k);

	for (; count >= PIXELS; count -= PIXELS, y += PIXELS, bgrx += PIXELS) {
		const __m256i code = _mm256_cvttps_epi32(avx2_luma(&w, avx2_bytes_at(y)));

		avx2_store(bgrx, avx2_interleave(code, code, code));
	}
	ycbcr_row_grey(k, y, count, bgrx);
}

/* Swaps vectors from both ends towards the middle. */
static void avx2_reverse(uint32_t *bgrx, int count)
{
	const __m256i order = _mm256_setr_epi32(7, 6, 5, 4, 3, 2, 1, 0);
	uint32_t *end = bgrx + count;

	for (; count >= 2 * PIXELS; count -= 2 * PIXELS, bgrx += PIXELS) {
		const __m256i left = _mm256_loadu_si256((const void *)bgrx);
		const __m256i right = _mm256_loadu_si256((const void *)(end - PIXELS));

		end -= PIXELS;
		avx2_store(end, _mm256_permutevar8x32_epi32(left, order));
		avx2_store(bgrx, _mm256_permutevar8x32_epi32(right, order));
	}
	bgrx_row_reverse(bgrx, count);
}

const struct frame_rows frame_rows_avx2 = {
	.name = "avx2",
	.needs = PROCESSOR_AVX2,
	.yuyv = avx2_yuyv,
	.uyvy = avx2_uyvy,
	.nv12 = avx2_nv12,
	.grey = avx2_grey,
	.reverse = avx2_reverse,
};
