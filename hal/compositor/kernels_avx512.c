#include "hal/compositor/kernels_isa.h"

#include <immintrin.h>

/* ---- sums16, sums8 ---- */

/* 32 pixels of a line as int16. */
KERNEL_INLINE __m512i line_of(const void *lines, uint32_t line, int part, const bool bytes)
{
	const char *from = (const char *)lines + (size_t)line * KERNEL_LINE_BYTES;

	return bytes ? _mm512_cvtepi8_epi16(_mm256_load_si256((const __m256i *)from + part))
		     : _mm512_load_si512(from);
}

/*
 * A run of lines, two at a time, side by side: p of one and p of the next are multiplied and added
 * by one instruction. acc[part][d][0] gets pixels 0-3, 8-11, 16-19, 24-27 of 32 and [1] the others,
 * as unpacking leaves them.
 *
 * Bytes go the same way, once they are int16. The dot product of four bytes takes more: digits must
 * be split in two for it, so there are twice the products and twice the sums in registers;
 * measured, it is a twentieth faster for one digit, a tenth slower for two and far slower beyond.
 */
KERNEL_INLINE void run_of(const void *lines, const struct kernel_weights *w, int from, int to,
			  const bool bytes, const int digits, __m512i acc[2][KERNEL_DIGITS][2])
{
	KERNEL_UNROLL
	for (int part = 0; part < 1 + bytes; part++) {
		KERNEL_UNROLL
		for (int d = 0; d < digits; d++)
			acc[part][d][0] = acc[part][d][1] = _mm512_setzero_si512();
	}
	for (int k = from; k < to; k += 2) {
		KERNEL_UNROLL
		for (int part = 0; part < 1 + bytes; part++) {
			const __m512i one = line_of(lines, w->line[k], part, bytes);
			const __m512i next = line_of(lines, w->line[k + 1], part, bytes);
			const __m512i low = _mm512_unpacklo_epi16(one, next);
			const __m512i high = _mm512_unpackhi_epi16(one, next);

			KERNEL_UNROLL
			for (int d = 0; d < digits; d++) {
				const __m512i pair =
					_mm512_set1_epi32(kernel_weight_pair(w->digit[d] + k));

				acc[part][d][0] = _mm512_dpwssd_epi32(acc[part][d][0], low, pair);
				acc[part][d][1] = _mm512_dpwssd_epi32(acc[part][d][1], high, pair);
			}
		}
	}
}

/* sum over the digits of acc_d * 4096^d, of 8 pixels. */
KERNEL_INLINE __m512i combined(__m512i acc[KERNEL_DIGITS][2], int which, int half, const int digits)
{
	__m512i sum = _mm512_setzero_si512();

	KERNEL_UNROLL
	for (int d = digits - 1; d >= 0; d--) {
		const __m256i narrow = half ? _mm512_extracti64x4_epi64(acc[d][which], 1)
					    : _mm512_castsi512_si256(acc[d][which]);

		sum = _mm512_add_epi64(_mm512_slli_epi64(sum, KERNEL_DIGIT_BITS),
				       _mm512_cvtepi32_epi64(narrow));
	}
	return sum;
}

KERNEL_INLINE void add_to(int64_t *sum, __m512i more)
{
	_mm512_storeu_si512(sum, _mm512_add_epi64(_mm512_loadu_si512(sum), more));
}

KERNEL_INLINE void sums_of(const void *lines, const struct kernel_weights *w, int64_t *sum,
			   const bool bytes, const int digits)
{
	__m512i acc[2][KERNEL_DIGITS][2], total[2][2][2];

	KERNEL_UNROLL
	for (int i = 0; i < 8; i++)
		total[i / 4][i / 2 % 2][i % 2] = _mm512_setzero_si512();
	kernel_fetch(lines, w, 0, kernel_run_end(w, 0));
	for (int k = 0; k < w->count; k += KERNEL_RUN) {
		const int end = kernel_run_end(w, k);

		kernel_fetch(lines, w, end, kernel_run_end(w, end));
		run_of(lines, w, k, end, bytes, digits, acc);
		KERNEL_UNROLL
		for (int i = 0; i < 4 + 4 * bytes; i++)
			total[i / 4][i / 2 % 2][i % 2] =
				_mm512_add_epi64(total[i / 4][i / 2 % 2][i % 2],
						 combined(acc[i / 4], i / 2 % 2, i % 2, digits));
	}
	KERNEL_UNROLL
	for (int i = 0; i < 2 + 2 * bytes; i++) { /* 0-3, 8-11 and 4-7, 12-15 into their order */
		const __m512i low = total[i / 2][0][i % 2], high = total[i / 2][1][i % 2];

		add_to(sum + 16 * i, _mm512_shuffle_i64x2(low, high, 0x44));
		add_to(sum + 16 * i + 8, _mm512_shuffle_i64x2(low, high, 0xee));
	}
}

KERNEL_INLINE void sums(const void *lines, const struct kernel_weights *w, int64_t *sum,
			const bool bytes)
{
	switch (w->digits) {
	case 1:
		sums_of(lines, w, sum, bytes, 1);
		break;
	case 2:
		sums_of(lines, w, sum, bytes, 2);
		break;
	case 3:
		sums_of(lines, w, sum, bytes, 3);
		break;
	default:
		sums_of(lines, w, sum, bytes, 4);
		break;
	}
}

static void sums16(const int16_t *lines, const struct kernel_weights *w, int64_t sum[KERNEL_LINE16])
{
	sums(lines, w, sum, false);
}

static void sums8(const int8_t *lines, const struct kernel_weights *w, int64_t sum[KERNEL_LINE8])
{
	sums(lines, w, sum, true);
}

/* ---- project ---- */

/* Values of a row until a lane of int32 has had its 32 products. */
#define ROW_RUN (16 * KERNEL_LANE_PRODUCTS)

/* The sums of a run of one row with all planes, channel by channel, added as int64. */
KERNEL_INLINE void row_run(const int16_t *row, const struct kernel_planes *p, int from, int to,
			   const int digits, __m512i total[3])
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
			for (int d = 0; d < digits; d++)
				part[c][d] = _mm512_dpwssd_epi32(
					part[c][d], x, _mm512_load_si512(p->plane[c][d] + k));
		}
	}
	KERNEL_UNROLL
	for (int c = 0; c < 3; c++) {
		__m512i sum = _mm512_setzero_si512();

		KERNEL_UNROLL
		for (int d = digits - 1; d >= 0; d--) {
			/* Even and odd places. */
			const __m512i even = _mm512_mul_epi32(part[c][d], _mm512_set1_epi64(1));
			const __m512i odd = _mm512_srai_epi64(part[c][d], 32);

			sum = _mm512_add_epi64(_mm512_slli_epi64(sum, KERNEL_DIGIT_BITS),
					       _mm512_add_epi64(odd, even));
		}
		total[c] = _mm512_add_epi64(total[c], sum);
	}
}

/* y = the sums over the lanes of each channel. */
static inline void store_lanes(int64_t *y, const __m512i total[3])
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

KERNEL_INLINE void project_of(const int16_t *rows, int count, int stride,
			      const struct kernel_planes *planes, int64_t (*y)[3], const int digits)
{
	for (int j = 0; j < count; j++, rows += stride) {
		__m512i total[3];

		total[0] = total[1] = total[2] = _mm512_setzero_si512();
		for (int k = 0; k < stride; k += ROW_RUN) {
			const int end = stride - k > ROW_RUN ? k + ROW_RUN : stride;

			row_run(rows, planes, k, end, digits, total);
		}
		store_lanes(y[j], total);
	}
}

static void project(const int16_t *rows, int count, int stride,
		    const struct kernel_vector vector[3], int64_t (*y)[3])
{
	struct kernel_planes planes;

	kernel_planes_fill(&planes, vector);
	switch (planes.digits) {
	case 0:
		memset(y, 0, (size_t)count * sizeof(*y));
		break;
	case 1:
		project_of(rows, count, stride, &planes, y, 1);
		break;
	case 2:
		project_of(rows, count, stride, &planes, y, 2);
		break;
	case 3:
		project_of(rows, count, stride, &planes, y, 3);
		break;
	default:
		project_of(rows, count, stride, &planes, y, 4);
		break;
	}
}

/* ---- fold ---- */

KERNEL_INLINE __m512i limit64(__m512i x)
{
	return _mm512_max_epi64(_mm512_min_epi64(x, _mm512_set1_epi64(KERNEL_LIMIT)),
				_mm512_set1_epi64(-(int64_t)KERNEL_LIMIT));
}

KERNEL_INLINE __m512i rounded(__m512i x, __m512i half, __m128i bits)
{
	return _mm512_sra_epi64(_mm512_add_epi64(x, half), bits);
}

/* Factors and tints up to 1, which most are, need no limit: their result is no larger. */
KERNEL_INLINE __m512i tinted(__m512i x, const uint16_t *tint, __mmask8 mask)
{
	const __m512i t = _mm512_cvtepu16_epi64(_mm_maskz_loadu_epi16(mask, tint));

	x = rounded(_mm512_mul_epi32(x, t), _mm512_set1_epi64(1 << 14), _mm_cvtsi32_si128(15));
	return _mm512_cmpgt_epi64_mask(t, _mm512_set1_epi64(1 << 15)) ? limit64(x) : x;
}

static void fold(const int64_t *sum, int count, int shift, uint32_t factor, const uint16_t *tint,
		 int32_t *to)
{
	/* The multiplication has signs, and 2^31 none: half of it, one bit less, is the same. */
	const int whole = factor >> 31 ? 29 : 30;
	const __m512i f = _mm512_set1_epi64(factor >> (30 - whole));
	const __m512i half1 = _mm512_set1_epi64(INT64_C(1) << (shift - 1));
	const __m512i half2 = _mm512_set1_epi64(INT64_C(1) << (whole - 1));
	const __m128i bits1 = _mm_cvtsi32_si128(shift), bits2 = _mm_cvtsi32_si128(whole);

	for (int p = 0; p < count; p += 8) {
		const __mmask8 mask = (__mmask8)(count - p >= 8 ? 0xff : (1 << (count - p)) - 1);
		const __m512i all = _mm512_maskz_loadu_epi64(mask, sum + p);
		__m512i x = limit64(rounded(all, half1, bits1));

		if (factor != 1U << 30)
			x = rounded(_mm512_mul_epi32(x, f), half2, bits2);
		if (factor > 1U << 30)
			x = limit64(x);
		if (tint)
			x = tinted(x, tint + p, mask);
		x = _mm512_add_epi64(x,
				     _mm512_cvtepi32_epi64(_mm256_maskz_loadu_epi32(mask, to + p)));
		_mm256_mask_storeu_epi32(to + p, mask, _mm512_cvtepi64_epi32(limit64(x)));
	}
}

/* ---- mix ---- */

/* Everything that is looked up stays in registers. */
struct tables {
	__m512i decode[8], a, b, c;
};

/* 256 words in 8 registers: four look-ups of 64, of which bits 6 and 7 choose one. */
KERNEL_INLINE __m512i decoded(const __m512i decode[8], __m512i code)
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

/* Words that hold the codes of 32 keys. */
KERNEL_INLINE __m512i encoded(const struct tables *k, __m512i key)
{
	const __m512i piece = _mm512_srli_epi16(key, 11);
	const __m512i t = _mm512_srli_epi16(_mm512_slli_epi16(key, 5), 1);
	const __m512i bend = _mm512_mulhi_epi16(_mm512_permutexvar_epi16(piece, k->c), t);
	const __m512i slope = _mm512_add_epi16(_mm512_permutexvar_epi16(piece, k->b), bend);
	const __m512i rise = _mm512_mulhi_epi16(slope, t);

	return _mm512_srli_epi16(_mm512_add_epi16(_mm512_permutexvar_epi16(piece, k->a), rise), 8);
}

/* The keys of one channel of 16 pixels, not yet clamped. */
KERNEL_INLINE __m512i keys(const struct kernel_row *row, int c, int x, __mmask16 mask, __m512 left,
			   __m512i linear)
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

KERNEL_INLINE __m512 rest_of(const uint16_t *coverage, __mmask16 mask)
{
	const __m512i a = _mm512_cvtepu16_epi32(_mm256_maskz_loadu_epi16(mask, coverage));
	const __m512i rest = _mm512_sub_epi32(_mm512_sub_epi32(_mm512_set1_epi32(65536), a),
					      _mm512_srli_epi32(a, 15));

	return _mm512_mul_ps(_mm512_cvtepi32_ps(rest),
			     _mm512_set1_ps(KERNEL_WHITE / 65535 / 65536));
}

/* Of each 16 bytes, 4 pixels, as words: bytes 0 and 1 of all, and byte 2. */
#define WORDS_B_G                                                                                  \
	_mm512_broadcast_i32x4(                                                                    \
		_mm_setr_epi8(0, -1, 4, -1, 8, -1, 12, -1, 1, -1, 5, -1, 9, -1, 13, -1))
#define WORDS_R                                                                                    \
	_mm512_broadcast_i32x4(                                                                    \
		_mm_setr_epi8(2, -1, 6, -1, 10, -1, 14, -1, -1, -1, -1, -1, -1, -1, -1, -1))
/* And back, from bytes B B B B G G G G R R R R. */
#define PIXELS                                                                                     \
	_mm512_broadcast_i32x4(_mm_setr_epi8(0, 4, 8, -1, 1, 5, 9, -1, 2, 6, 10, -1, 3, 7, 11, -1))

KERNEL_INLINE void mix16(const struct kernel_row *row, const struct tables *k, int x,
			 __mmask16 mask)
{
	const __m512i zero = _mm512_setzero_si512();
	const __m512i in = _mm512_maskz_loadu_epi32(mask, row->background + (size_t)x * 4);
	const __m512 left = rest_of(row->coverage + x, mask);
	const __m512i bg = decoded(k->decode, _mm512_shuffle_epi8(in, WORDS_B_G));
	const __m512i r = decoded(k->decode, _mm512_shuffle_epi8(in, WORDS_R));
	const __m512i key_b = keys(row, 2, x, mask, left, _mm512_unpacklo_epi16(bg, zero));
	const __m512i key_g = keys(row, 1, x, mask, left, _mm512_unpackhi_epi16(bg, zero));
	const __m512i key_r = keys(row, 0, x, mask, left, _mm512_unpacklo_epi16(r, zero));
	/* Packing to words without signs clamps to 0..65535. */
	const __m512i out_bg = encoded(k, _mm512_packus_epi32(key_b, key_g));
	const __m512i out_r = encoded(k, _mm512_packus_epi32(key_r, key_r));
	const __m512i out = _mm512_shuffle_epi8(_mm512_packus_epi16(out_bg, out_r), PIXELS);

	_mm512_mask_storeu_epi32(row->out + (size_t)x * 4, mask,
				 _mm512_or_si512(out, _mm512_set1_epi32((int)0xff000000)));
}

static void mix(const struct kernel_row *row)
{
	struct tables k;
	int x = 0;

	for (int i = 0; i < 8; i++)
		k.decode[i] = _mm512_load_si512(row->curves->decode + 32 * i);
	k.a = _mm512_load_si512(row->curves->a);
	k.b = _mm512_load_si512(row->curves->b);
	k.c = _mm512_load_si512(row->curves->c);
	for (; x + 16 <= row->count; x += 16)
		mix16(row, &k, x, 0xffff);
	if (x < row->count)
		mix16(row, &k, x, (__mmask16)((1 << (row->count - x)) - 1));
}

const struct kernels kernels_avx512 = {
	.name = "avx512-vnni",
	.supported = kernels_supported_avx512,
	.sums16 = sums16,
	.sums8 = sums8,
	.project = project,
	.fold = fold,
	.mix = mix,
};
