#include "hal/compositor/kernels_isa.h"

#include <immintrin.h>

/* ---- sums16 ---- */

/* A run of lines, two at a time, side by side: p of one and p of the next are multiplied and added
 * by one instruction. low holds pixels 0-3, 8-11, 16-19, 24-27 and high the others, as the
 * unpacking leaves them. */
KERNEL_INLINE void run16(const int16_t *lines, const struct kernel_weights *w, int from, int to,
			 const int digits, __m512i part[KERNEL_DIGITS][2])
{
	KERNEL_UNROLL
	for (int d = 0; d < digits; d++)
		part[d][0] = part[d][1] = _mm512_setzero_si512();
	for (int k = from; k < to; k += 2) {
		const __m512i one = _mm512_load_si512(lines + (size_t)w->line[k] * KERNEL_LINE16);
		const __m512i next =
			_mm512_load_si512(lines + (size_t)w->line[k + 1] * KERNEL_LINE16);
		const __m512i low = _mm512_unpacklo_epi16(one, next);
		const __m512i high = _mm512_unpackhi_epi16(one, next);

		KERNEL_UNROLL
		for (int d = 0; d < digits; d++) {
			const __m512i pair = _mm512_set1_epi32(kernel_weight_pair(w->digit[d] + k));

			part[d][0] = _mm512_dpwssd_epi32(part[d][0], low, pair);
			part[d][1] = _mm512_dpwssd_epi32(part[d][1], high, pair);
		}
	}
}

/* sum over the digits of part_d * 4096^d, of 8 pixels. */
KERNEL_INLINE __m512i combined(__m512i part[KERNEL_DIGITS][2], int which, int half,
			       const int digits)
{
	__m512i sum = _mm512_setzero_si512();

	KERNEL_UNROLL
	for (int d = digits - 1; d >= 0; d--) {
		const __m256i narrow = half ? _mm512_extracti64x4_epi64(part[d][which], 1)
					    : _mm512_castsi512_si256(part[d][which]);

		sum = _mm512_add_epi64(_mm512_slli_epi64(sum, KERNEL_DIGIT_BITS),
				       _mm512_cvtepi32_epi64(narrow));
	}
	return sum;
}

static inline void add_to(int64_t *sum, __m512i more)
{
	_mm512_storeu_si512(sum, _mm512_add_epi64(_mm512_loadu_si512(sum), more));
}

KERNEL_INLINE void sums16_of(const int16_t *lines, const struct kernel_weights *w, int64_t *sum,
			     const int digits)
{
	__m512i part[KERNEL_DIGITS][2], total[2][2];

	total[0][0] = total[0][1] = total[1][0] = total[1][1] = _mm512_setzero_si512();
	for (int k = 0; k < w->count; k += KERNEL_RUN) {
		const int end = w->count - k > KERNEL_RUN ? k + KERNEL_RUN : w->count;

		run16(lines, w, k, end, digits, part);
		KERNEL_UNROLL
		for (int which = 0; which < 2; which++) {
			KERNEL_UNROLL
			for (int half = 0; half < 2; half++)
				total[which][half] = _mm512_add_epi64(
					total[which][half], combined(part, which, half, digits));
		}
	}
	KERNEL_UNROLL
	for (int half = 0; half < 2; half++) { /* 0-3, 8-11 and 4-7, 12-15 into their order */
		const __m512i low = total[0][half], high = total[1][half];

		add_to(sum + 16 * half, _mm512_shuffle_i64x2(low, high, 0x44));
		add_to(sum + 16 * half + 8, _mm512_shuffle_i64x2(low, high, 0xee));
	}
}

static void sums16(const int16_t *lines, const struct kernel_weights *w, int64_t sum[KERNEL_LINE16])
{
	switch (w->digits) {
	case 1:
		sums16_of(lines, w, sum, 1);
		break;
	case 2:
		sums16_of(lines, w, sum, 2);
		break;
	case 3:
		sums16_of(lines, w, sum, 3);
		break;
	default:
		sums16_of(lines, w, sum, 4);
		break;
	}
}

/* ---- sums8 ---- */

/*
 * Four lines at a time, so that the four bytes of a pixel lie side by side, times four weights of
 * one byte: each digit is split into 256 h + l, -8 <= h <= 8 and -128 <= l <= 127. The instruction
 * wants one side without a sign: x + 128, and 128 times the sum of all digits is taken off at last.
 * |(x + 128) l| <= 255 * 128, so 65536 lines add up in int32: 65536 * 32640 < 2^31.
 */
#define RUN8 65536
#define SPLIT 32 /* lines whose digits are split at once */

struct split {
	_Alignas(64) int8_t low[2][SPLIT], high[2][SPLIT];
};

KERNEL_INLINE void split_digits(struct split *split, const struct kernel_weights *w, int first,
				int k, int count, const int digits, __m512i all[2])
{
	const __mmask32 mask = (__mmask32)(count >= SPLIT ? ~0U : (1U << count) - 1);

	KERNEL_UNROLL
	for (int d = 0; d < digits; d++) {
		const __m512i digit = _mm512_maskz_loadu_epi16(mask, w->digit[first + d] + k);
		const __m512i high =
			_mm512_srai_epi16(_mm512_add_epi16(digit, _mm512_set1_epi16(128)), 8);

		_mm256_store_si256((__m256i *)split->low[d], _mm512_cvtepi16_epi8(digit));
		_mm256_store_si256((__m256i *)split->high[d], _mm512_cvtepi16_epi8(high));
		all[d] = _mm512_dpwssd_epi32(all[d], digit, _mm512_set1_epi16(1));
	}
}

/* quad[i] holds pixels 4i..4i+3 of each 16. */
KERNEL_INLINE void quads_of(const int8_t *lines, const uint32_t line[4], __m512i quad[4])
{
	const __m512i sign = _mm512_set1_epi8(-128);
	__m512i x[4], low[2], high[2];

	KERNEL_UNROLL
	for (int i = 0; i < 4; i++)
		x[i] = _mm512_xor_si512(_mm512_load_si512(lines + (size_t)line[i] * KERNEL_LINE8),
					sign);
	KERNEL_UNROLL
	for (int i = 0; i < 2; i++) {
		low[i] = _mm512_unpacklo_epi8(x[2 * i], x[2 * i + 1]);
		high[i] = _mm512_unpackhi_epi8(x[2 * i], x[2 * i + 1]);
	}
	quad[0] = _mm512_unpacklo_epi16(low[0], low[1]);
	quad[1] = _mm512_unpackhi_epi16(low[0], low[1]);
	quad[2] = _mm512_unpacklo_epi16(high[0], high[1]);
	quad[3] = _mm512_unpackhi_epi16(high[0], high[1]);
}

KERNEL_INLINE __m512i weight_quad(const int8_t *weights)
{
	int32_t quad;

	memcpy(&quad, weights, sizeof(quad));
	return _mm512_set1_epi32(quad);
}

/* From pixels 4i..4i+3 of each 16 in part[i] to 16 j.. in part[j]. */
KERNEL_INLINE void into_order(__m512i part[4])
{
	const __m512i a = _mm512_shuffle_i32x4(part[0], part[1], 0x44);
	const __m512i b = _mm512_shuffle_i32x4(part[2], part[3], 0x44);
	const __m512i c = _mm512_shuffle_i32x4(part[0], part[1], 0xee);
	const __m512i d = _mm512_shuffle_i32x4(part[2], part[3], 0xee);

	part[0] = _mm512_shuffle_i32x4(a, b, 0x88);
	part[1] = _mm512_shuffle_i32x4(a, b, 0xdd);
	part[2] = _mm512_shuffle_i32x4(c, d, 0x88);
	part[3] = _mm512_shuffle_i32x4(c, d, 0xdd);
}

KERNEL_INLINE void add_digit(int64_t *sum, __m512i low[4], __m512i high[4], __m512i all, int digit)
{
	const __m128i bits = _mm_cvtsi32_si128(digit * KERNEL_DIGIT_BITS);
	/* Of 65536 lines: below 2^27, and with the 128 below 2^34. */
	const __m512i off = _mm512_set1_epi64(128 * (int64_t)_mm512_reduce_add_epi32(all));

	into_order(low);
	into_order(high);
	for (int p = 0; p < KERNEL_LINE8; p += 8) {
		const int i = p / 16;
		const __m256i l = p % 16 ? _mm512_extracti64x4_epi64(low[i], 1)
					 : _mm512_castsi512_si256(low[i]);
		const __m256i h = p % 16 ? _mm512_extracti64x4_epi64(high[i], 1)
					 : _mm512_castsi512_si256(high[i]);
		const __m512i both = _mm512_add_epi64(
			_mm512_cvtepi32_epi64(l), _mm512_slli_epi64(_mm512_cvtepi32_epi64(h), 8));

		add_to(sum + p, _mm512_sll_epi64(_mm512_sub_epi64(both, off), bits));
	}
}

KERNEL_INLINE void run8(const int8_t *lines, const struct kernel_weights *w, int first, int from,
			int to, int64_t *sum, const int digits)
{
	__m512i low[2][4], high[2][4], all[2], quad[4];
	struct split split;

	KERNEL_UNROLL
	for (int d = 0; d < digits; d++) {
		all[d] = _mm512_setzero_si512();
		KERNEL_UNROLL
		for (int i = 0; i < 4; i++)
			low[d][i] = high[d][i] = all[d];
	}
	for (int k = from; k < to; k += 4) {
		const int at = (k - from) % SPLIT;
		const uint32_t *l = w->line + k;
		/* Where two lines are left they stand in for the others, whose weights are 0. */
		const int other = to - k > 2 ? 2 : 0;
		const uint32_t line[4] = {l[0], l[1], l[other], l[other + 1]};

		if (at == 0)
			split_digits(&split, w, first, k, to - k, digits, all);
		quads_of(lines, line, quad);
		KERNEL_UNROLL
		for (int d = 0; d < digits; d++) {
			const __m512i l4 = weight_quad(split.low[d] + at);
			const __m512i h4 = weight_quad(split.high[d] + at);

			KERNEL_UNROLL
			for (int i = 0; i < 4; i++) {
				low[d][i] = _mm512_dpbusd_epi32(low[d][i], quad[i], l4);
				high[d][i] = _mm512_dpbusd_epi32(high[d][i], quad[i], h4);
			}
		}
	}
	KERNEL_UNROLL
	for (int d = 0; d < digits; d++)
		add_digit(sum, low[d], high[d], all[d], first + d);
}

static void sums8(const int8_t *lines, const struct kernel_weights *w, int64_t sum[KERNEL_LINE8])
{
	for (int k = 0; k < w->count; k += RUN8) {
		const int end = w->count - k > RUN8 ? k + RUN8 : w->count;

		for (int d = 0; d < w->digits; d += 2) {
			if (w->digits - d >= 2)
				run8(lines, w, d, k, end, sum, 2);
			else
				run8(lines, w, d, k, end, sum, 1);
		}
	}
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
