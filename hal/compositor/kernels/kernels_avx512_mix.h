/* SPDX-License-Identifier: MIT */
/* mix() for AVX-512; part of kernels_avx512.c. */

/* The tables of mix(), which stay in registers. */
struct avx512_tables {
	__m512i decode[8], a, b, c;
};

/* Looks up in 256 words in 8 registers: four look-ups in 64 words; bits 6 and 7 choose one. */
KERNEL_INLINE __m512i avx512_decoded(const __m512i decode[8], __m512i code)
{
	const __mmask32 bit6 = _mm512_test_epi16_mask(code, _mm512_set1_epi16(64));
	const __mmask32 bit7 = _mm512_test_epi16_mask(code, _mm512_set1_epi16(128));
	const __m512i low =
		_mm512_mask_blend_epi16(bit6, _mm512_permutex2var_epi16(decode[0], code, decode[1]),
					_mm512_permutex2var_epi16(decode[2], code, decode[3]));
	const __m512i high =
		_mm512_mask_blend_epi16(bit6, _mm512_permutex2var_epi16(decode[4], code, decode[5]),
					_mm512_permutex2var_epi16(decode[6], code, decode[7]));

	return _mm512_mask_blend_epi16(bit7, low, high);
}

/* Encodes 32 keys to codes; all are words. */
KERNEL_INLINE __m512i avx512_encoded(const struct avx512_tables *k, __m512i key)
{
	const __m512i piece = _mm512_srli_epi16(key, 11);
	const __m512i t = _mm512_srli_epi16(_mm512_slli_epi16(key, 5), 1);
	const __m512i bend = _mm512_mulhi_epi16(_mm512_permutexvar_epi16(piece, k->c), t);
	const __m512i slope = _mm512_add_epi16(_mm512_permutexvar_epi16(piece, k->b), bend);
	const __m512i rise = _mm512_mulhi_epi16(slope, t);

	return _mm512_srli_epi16(_mm512_add_epi16(_mm512_permutexvar_epi16(piece, k->a), rise), 8);
}

/* Computes the keys of one channel of 16 pixels, not yet clamped. */
KERNEL_INLINE __m512i avx512_keys(const struct kernel_row *row, int c, int x, __mmask16 mask,
				  __m512 left, __m512i linear)
{
	const __m512 object =
		_mm512_cvtepi32_ps(_mm512_maskz_loadu_epi32(mask, row->object[c] + x));
	const __m512 taken = _mm512_cvtepi32_ps(_mm512_maskz_loadu_epi32(mask, row->taken[c] + x));
	const __m512 raised =
		_mm512_add_ps(_mm512_mul_ps(object, _mm512_set1_ps(KERNEL_WHITE * 0x1p-24f)),
			      _mm512_set1_ps(KERNEL_BLACK));
	__m512 ratio = _mm512_sub_ps(_mm512_set1_ps(1.0f),
				     _mm512_mul_ps(taken, _mm512_set1_ps(0x1p-24f)));
	__m512 v;

	ratio = _mm512_min_ps(_mm512_max_ps(ratio, _mm512_setzero_ps()), _mm512_set1_ps(16.0f));
	v = _mm512_add_ps(_mm512_mul_ps(_mm512_mul_ps(ratio, left), _mm512_cvtepi32_ps(linear)),
			  raised);
	return _mm512_sub_epi32(_mm512_srai_epi32(_mm512_castps_si512(v), 10),
				_mm512_set1_epi32(KERNEL_KEY_BASE));
}

KERNEL_INLINE __m512 avx512_rest_of(const uint16_t *coverage, __mmask16 mask)
{
	const __m512i a = _mm512_cvtepu16_epi32(_mm256_maskz_loadu_epi16(mask, coverage));
	const __m512i rest = _mm512_sub_epi32(_mm512_sub_epi32(_mm512_set1_epi32(65536), a),
					      _mm512_srli_epi32(a, 15));

	return _mm512_mul_ps(_mm512_cvtepi32_ps(rest),
			     _mm512_set1_ps(KERNEL_WHITE / 65535 / 65536));
}

/* Shuffles that widen bytes 0 and 1 (B, G), or byte 2 (R), of each 4 pixels to words. */
#define WORDS_B_G                                                                                  \
	_mm512_broadcast_i32x4(                                                                    \
		_mm_setr_epi8(0, -1, 4, -1, 8, -1, 12, -1, 1, -1, 5, -1, 9, -1, 13, -1))
#define WORDS_R                                                                                    \
	_mm512_broadcast_i32x4(                                                                    \
		_mm_setr_epi8(2, -1, 6, -1, 10, -1, 14, -1, -1, -1, -1, -1, -1, -1, -1, -1))
/* Shuffle from bytes B B B B G G G G R R R R back to 4 pixels. */
#define PIXELS                                                                                     \
	_mm512_broadcast_i32x4(_mm_setr_epi8(0, 4, 8, -1, 1, 5, 9, -1, 2, 6, 10, -1, 3, 7, 11, -1))

KERNEL_INLINE void avx512_mix16(const struct kernel_row *row, const struct avx512_tables *k, int x,
				__mmask16 mask)
{
	const __m512i zero = _mm512_setzero_si512();
	const __m512i in = _mm512_maskz_loadu_epi32(mask, row->background + (size_t)x * 4);
	const __m512 left = avx512_rest_of(row->coverage + x, mask);
	const __m512i bg = avx512_decoded(k->decode, _mm512_shuffle_epi8(in, WORDS_B_G));
	const __m512i r = avx512_decoded(k->decode, _mm512_shuffle_epi8(in, WORDS_R));
	const __m512i key_b = avx512_keys(row, 2, x, mask, left, _mm512_unpacklo_epi16(bg, zero));
	const __m512i key_g = avx512_keys(row, 1, x, mask, left, _mm512_unpackhi_epi16(bg, zero));
	const __m512i key_r = avx512_keys(row, 0, x, mask, left, _mm512_unpacklo_epi16(r, zero));
	/* Packing to unsigned words clamps to 0..65535. */
	const __m512i out_bg = avx512_encoded(k, _mm512_packus_epi32(key_b, key_g));
	const __m512i out_r = avx512_encoded(k, _mm512_packus_epi32(key_r, key_r));
	const __m512i out = _mm512_shuffle_epi8(_mm512_packus_epi16(out_bg, out_r), PIXELS);

	_mm512_mask_storeu_epi32(row->out + (size_t)x * 4, mask,
				 _mm512_or_si512(out, _mm512_set1_epi32((int)0xff000000)));
}

static void avx512_mix(const struct kernel_row *rows)
{
	struct kernel_row row = *rows;
	struct avx512_tables k;

	for (int i = 0; i < 8; i++)
		k.decode[i] = _mm512_load_si512(row.curves->decode + 32 * i);
	k.a = _mm512_load_si512(row.curves->a);
	k.b = _mm512_load_si512(row.curves->b);
	k.c = _mm512_load_si512(row.curves->c);
	for (int y = 0; y < rows->rows; y++, kernel_row_next(&row)) {
		const int whole = row.count / 16 * 16;

		for (int x = 0; x < whole; x += 16)
			avx512_mix16(&row, &k, x, 0xffff);
		if (whole < row.count)
			avx512_mix16(&row, &k, whole, (__mmask16)((1 << (row.count - whole)) - 1));
	}
}
