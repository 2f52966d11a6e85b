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
				  __m512 left, __m512i linear, const bool bare)
{
	const __m512 taken = _mm512_cvtepi32_ps(_mm512_maskz_loadu_epi32(mask, row->taken[c] + x));
	__m512 raised = _mm512_set1_ps(KERNEL_BLACK), ratio, v;

	if (!bare) {
		const __m512i object = _mm512_maskz_loadu_epi32(mask, row->object[c] + x);

		raised = _mm512_add_ps(_mm512_mul_ps(_mm512_cvtepi32_ps(object),
						     _mm512_set1_ps(KERNEL_WHITE * 0x1p-24f)),
				       raised);
	}
	ratio = _mm512_sub_ps(_mm512_set1_ps(1.0f), _mm512_mul_ps(taken, _mm512_set1_ps(0x1p-24f)));
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

/* Some of 16 pixels of a row. */
struct avx512_part {
	const struct kernel_row *row;
	__mmask16 mask;
};

/* Mixes 16 pixels each of two rows, which share the look-ups for R. */
KERNEL_INLINE void avx512_mix_two(const struct avx512_part part[2], const struct avx512_tables *k,
				  int x, const bool bare)
{
	const __m512i zero = _mm512_setzero_si512();
	const __m512i opaque = _mm512_set1_epi32((int)0xff000000);
	__m512i in[2], bg[2], r, key[2];

	for (int i = 0; i < 2; i++) {
		in[i] = _mm512_maskz_loadu_epi32(part[i].mask,
						 part[i].row->background + (size_t)x * 4);
		bg[i] = avx512_decoded(k->decode, _mm512_shuffle_epi8(in[i], WORDS_B_G));
	}
	r = avx512_decoded(k->decode, _mm512_unpacklo_epi64(_mm512_shuffle_epi8(in[0], WORDS_R),
							    _mm512_shuffle_epi8(in[1], WORDS_R)));
	for (int i = 0; i < 2; i++) {
		const struct kernel_row *row = part[i].row;
		const __mmask16 mask = part[i].mask;
		const __m512 left = bare ? _mm512_set1_ps(KERNEL_WHITE / 65535)
					 : avx512_rest_of(row->coverage + x, mask);
		const __m512i red = i ? _mm512_unpackhi_epi16(r, zero)
				      : _mm512_unpacklo_epi16(r, zero);

		/* Packing to unsigned words clamps to 0..65535. */
		bg[i] = avx512_encoded(
			k,
			_mm512_packus_epi32(avx512_keys(row, 2, x, mask, left,
							_mm512_unpacklo_epi16(bg[i], zero), bare),
					    avx512_keys(row, 1, x, mask, left,
							_mm512_unpackhi_epi16(bg[i], zero), bare)));
		key[i] = avx512_keys(row, 0, x, mask, left, red, bare);
	}
	r = avx512_encoded(k, _mm512_packus_epi32(key[0], key[1]));
	for (int i = 0; i < 2; i++) {
		const __m512i reds = i ? _mm512_unpackhi_epi64(r, r) : r;
		const __m512i out = _mm512_shuffle_epi8(_mm512_packus_epi16(bg[i], reds), PIXELS);

		_mm512_mask_storeu_epi32(part[i].row->out + (size_t)x * 4, part[i].mask,
					 _mm512_or_si512(out, opaque));
	}
}

KERNEL_INLINE void avx512_mix_rows(const struct kernel_row *rows, const bool bare)
{
	struct kernel_row row = *rows, next = *rows;
	struct avx512_tables k;

	for (int i = 0; i < 8; i++)
		k.decode[i] = _mm512_load_si512(row.curves->decode + 32 * i);
	k.a = _mm512_load_si512(row.curves->a);
	k.b = _mm512_load_si512(row.curves->b);
	k.c = _mm512_load_si512(row.curves->c);
	for (int y = 0; y < rows->rows; y += 2) {
		kernel_row_next(&next);
		for (int x = 0; x < row.count; x += 16) {
			const int left = row.count - x;
			const __mmask16 mask = left >= 16 ? UINT16_MAX
							  : (__mmask16)((1 << left) - 1);

			avx512_mix_two(
				(struct avx512_part[2]){{&row, mask},
							{&next, y + 1 < rows->rows ? mask : 0}},
				&k, x, bare);
		}
		kernel_row_next(&next);
		row = next;
	}
}

static void avx512_mix(const struct kernel_row *rows)
{
	if (rows->coverage)
		avx512_mix_rows(rows, false);
	else
		avx512_mix_rows(rows, true);
}
