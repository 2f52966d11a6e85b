/* SPDX-License-Identifier: MIT */
/*
 * The kernels of SSE4.1 and AVX2, for vectors of 16 and of 32 bytes. AVX2 repeats most operations
 * in two lanes of 16 bytes. The including file defines, for its width:
 *
 *     vector, vector_float
 *     SIMD(name)            the intrinsic of that name
 *     SIMD_BITS(name)       the intrinsic of that name with the suffix _si128 or _si256
 *     LOAD(p), STORE(p, x)  unaligned
 *     LOAD_ALIGNED(p)
 *     LOAD_WIDE8(p)         as many int8 as a vector has int16, widened
 *     LOAD_WIDE16(p)        as many uint16 as a vector has int32, widened
 *     IN_ORDER_LOW(a, b)    from a = unpacklo(x, y), b = unpackhi(x, y): low half in memory order
 *     IN_ORDER_HIGH(a, b)   the same: high half
 *     IN_ORDER_64(x)        memory order for pairs of int32 packed from two vectors lane by lane
 *     AS_FLOAT(x)           the same bits
 *     LANES(x)              16 bytes repeated in each lane
 *     x86_linear_of(row, x, byte)    linear[] of byte `byte` of as many pixels as a vector has
 *                                    floats, from pixel x
 */
#include <immintrin.h>

#define WORDS ((int)sizeof(vector) / 2)
#define DWORDS ((int)sizeof(vector) / 4)

/* ---- sums16, sums8 ---- */

/* Loads two vectors of int16 of a line, from pixel p. */
KERNEL_INLINE void x86_line_of(const void *lines, size_t at, int p, const bool bytes, vector x[2])
{
	if (bytes) {
		const int8_t *from = (const int8_t *)lines + at + p;

		x[0] = LOAD_WIDE8(from);
		x[1] = LOAD_WIDE8(from + WORDS);
	} else {
		const int16_t *from = (const int16_t *)lines + at / sizeof(int16_t) + p;

		x[0] = LOAD_ALIGNED(from);
		x[1] = LOAD_ALIGNED(from + WORDS);
	}
}

/* Sums one run of lines for 2 * WORDS pixels of a channel and one or two digits. Two lines are
 * interleaved, so that madd multiplies both and adds. acc[] holds groups of four pixels in the
 * order of unpacklo and unpackhi. */
KERNEL_INLINE void x86_add_run(const void *lines, const struct kernel_weights *w, int c, int first,
			       int from, int to, int p, const bool bytes, const int digits,
			       vector acc[2][4])
{
	vector one[2], next[2], both[4];
	const int16_t *digit = kernel_digit(w, from, c, first);

	KERNEL_UNROLL
	for (int d = 0; d < digits; d++)
		acc[d][0] = acc[d][1] = acc[d][2] = acc[d][3] = SIMD_BITS(setzero)();
	for (int k = from; k < to; k += 2) {
		x86_line_of(lines, w->line[k] * w->step, p, bytes, one);
		x86_line_of(lines, w->line[k + 1] * w->step, p, bytes, next);
		KERNEL_UNROLL
		for (int i = 0; i < 2; i++) {
			both[2 * i] = SIMD(unpacklo_epi16)(one[i], next[i]);
			both[2 * i + 1] = SIMD(unpackhi_epi16)(one[i], next[i]);
		}
		KERNEL_UNROLL
		for (int d = 0; d < digits; d++) {
			const vector pair = SIMD(set1_epi32)(kernel_weight_pair(digit + 2 * d));

			KERNEL_UNROLL
			for (int i = 0; i < 4; i++)
				acc[d][i] = SIMD(add_epi32)(acc[d][i],
							    SIMD(madd_epi16)(both[i], pair));
		}
		digit += 2 * 3 * w->digits;
	}
}

/* sum += (result of a run) * 4096^first * 2^shift */
KERNEL_INLINE void x86_run_of(const void *lines, const struct kernel_weights *w, int c, int first,
			      int from, int to, int p, int64_t *sum, const bool bytes,
			      const int digits)
{
	_Alignas(32) int32_t part[2][2 * WORDS];
	const int shift = w->shift + first * KERNEL_DIGIT_BITS;
	vector acc[2][4];

	x86_add_run(lines, w, c, first, from, to, p, bytes, digits, acc);
	KERNEL_UNROLL
	for (int d = 0; d < digits; d++) {
		KERNEL_UNROLL
		for (int i = 0; i < 4; i += 2) {
			STORE(part[d] + i * DWORDS, IN_ORDER_LOW(acc[d][i], acc[d][i + 1]));
			STORE(part[d] + (i + 1) * DWORDS, IN_ORDER_HIGH(acc[d][i], acc[d][i + 1]));
		}
	}
	for (int i = 0; i < 2 * WORDS; i++) {
		uint64_t more = (uint64_t)(int64_t)part[0][i];

		if (digits == 2)
			more += (uint64_t)(int64_t)part[1][i] << KERNEL_DIGIT_BITS;
		sum[p + i] = (int64_t)((uint64_t)sum[p + i] + (more << shift));
	}
}

KERNEL_INLINE void x86_channel_of(const void *lines, const struct kernel_weights *w, int c,
				  int from, int to, int p, int64_t *sum, const bool bytes)
{
	lines = (const char *)lines + (size_t)c * w->channel;
	for (int d = 0; d < w->digits; d += 2) {
		if (w->digits - d >= 2)
			x86_run_of(lines, w, c, d, from, to, p, sum, bytes, 2);
		else
			x86_run_of(lines, w, c, d, from, to, p, sum, bytes, 1);
	}
}

KERNEL_INLINE void x86_sums(const void *lines, const struct kernel_weights *w,
			    int64_t *const sum[3], const bool bytes)
{
	const int pixels = bytes ? KERNEL_LINE8 : KERNEL_LINE16;

	kernel_begin(w, sum, pixels);
	for (int k = 0, end; k < w->count; k = end) {
		end = kernel_run_end(w, k, bytes);
		kernel_fetch(lines, w, end, kernel_run_end(w, end, bytes));
		for (int p = 0; p < pixels; p += 2 * WORDS) {
			for (int c = 0; c < 3; c++)
				x86_channel_of(lines, w, c, k, end, p, sum[c], bytes);
		}
	}
}

static void x86_sums16(const int16_t *lines, const struct kernel_weights *w, int64_t *const sum[3])
{
	x86_sums(lines, w, sum, false);
}

static void x86_sums8(const int8_t *lines, const struct kernel_weights *w, int64_t *const sum[3])
{
	x86_sums(lines, w, sum, true);
}

/* ---- values16, values8 ---- */

/* Returns (acc_0 + 4096 acc_1) * 4096^first of one vector, rounded and shifted down, modulo 2^32.
 * Adding the half does not overflow acc_0: 32 * 32767 * 2048 + 2048 < 2^31. */
KERNEL_INLINE vector x86_value_of(vector acc[2][4], int i, const bool bytes, const int first,
				  const int digits)
{
	const int down = bytes ? KERNEL_VALUE_SHIFT8 : KERNEL_VALUE_SHIFT16;
	const int up = first * KERNEL_DIGIT_BITS - down;
	vector x = acc[0][i];

	if (first)
		x = SIMD(slli_epi32)(x, up);
	else
		x = SIMD(srai_epi32)(SIMD(add_epi32)(x, SIMD(set1_epi32)(1 << (down - 1))), down);
	if (digits == 2)
		x = SIMD(add_epi32)(x, SIMD(slli_epi32)(acc[1][i], up + KERNEL_DIGIT_BITS));
	return x;
}

KERNEL_INLINE void x86_add_values(int32_t *value, vector more, const bool old)
{
	STORE(value, old ? SIMD(add_epi32)(LOAD(value), more) : more);
}

KERNEL_INLINE void x86_value_run(const void *lines, const struct kernel_weights *w, int c, int p,
				 int32_t *value, const bool bytes, const int first,
				 const int digits)
{
	const bool old = first || !w->fresh;
	vector acc[2][4];

	x86_add_run(lines, w, c, first, 0, w->count, p, bytes, digits, acc);
	KERNEL_UNROLL
	for (int i = 0; i < 4; i += 2) {
		const vector a = x86_value_of(acc, i, bytes, first, digits);
		const vector b = x86_value_of(acc, i + 1, bytes, first, digits);

		x86_add_values(value + p + i * DWORDS, IN_ORDER_LOW(a, b), old);
		x86_add_values(value + p + (i + 1) * DWORDS, IN_ORDER_HIGH(a, b), old);
	}
}

KERNEL_INLINE void x86_values(const void *lines, const struct kernel_weights *w,
			      int32_t *const value[3], const bool bytes)
{
	const int pixels = bytes ? KERNEL_LINE8 : KERNEL_LINE16;

	for (int c = 0; c < 3; c++) {
		const char *from = (const char *)lines + (size_t)c * w->channel;

		for (int p = 0; p < pixels; p += 2 * WORDS) {
			if (w->digits >= 2)
				x86_value_run(from, w, c, p, value[c], bytes, 0, 2);
			else
				x86_value_run(from, w, c, p, value[c], bytes, 0, 1);
			if (w->digits == 4)
				x86_value_run(from, w, c, p, value[c], bytes, 2, 2);
			else if (w->digits == 3)
				x86_value_run(from, w, c, p, value[c], bytes, 2, 1);
		}
	}
}

static void x86_values16(const int16_t *lines, const struct kernel_weights *w,
			 int32_t *const value[3])
{
	x86_values(lines, w, value, false);
}

static void x86_values8(const int8_t *lines, const struct kernel_weights *w,
			int32_t *const value[3])
{
	x86_values(lines, w, value, true);
}

/* ---- project ---- */

/* Values of a row until each lane of int32 holds 32 products, two from each vector. */
#define ROW_RUN (WORDS / 2 * KERNEL_LANE_PRODUCTS)

/* Adds even and odd lanes of int32 in int64, times 4096^digit. */
KERNEL_INLINE vector x86_widened(vector x, int digit)
{
	const vector unit = SIMD(set1_epi64x)(INT64_C(1) << digit * KERNEL_DIGIT_BITS);

	return SIMD(add_epi64)(SIMD(mul_epi32)(x, unit),
			       SIMD(mul_epi32)(SIMD(srli_epi64)(x, 32), unit));
}

/* Multiplies one row with one or two digits of all channels, in int64. */
KERNEL_INLINE void x86_row_of(const int16_t *row, int stride, const struct kernel_planes *planes,
			      int first, vector total[3], const int digits)
{
	KERNEL_UNROLL
	for (int c = 0; c < 3; c++)
		total[c] = SIMD_BITS(setzero)();
	for (int from = 0; from < stride; from += ROW_RUN) {
		const int to = stride - from > ROW_RUN ? from + ROW_RUN : stride;
		vector acc[3][2];

		KERNEL_UNROLL
		for (int c = 0; c < 3; c++)
			acc[c][0] = acc[c][1] = SIMD_BITS(setzero)();
		for (int k = from; k < to; k += WORDS) {
			const vector x = LOAD_ALIGNED(row + k);

			KERNEL_UNROLL
			for (int c = 0; c < 3; c++) {
				KERNEL_UNROLL
				for (int d = 0; d < digits; d++) {
					const int16_t *plane = planes->plane[c][first + d];

					acc[c][d] = SIMD(add_epi32)(
						acc[c][d],
						SIMD(madd_epi16)(x, LOAD_ALIGNED(plane + k)));
				}
			}
		}
		KERNEL_UNROLL
		for (int c = 0; c < 3; c++) {
			KERNEL_UNROLL
			for (int d = 0; d < digits; d++) {
				total[c] = SIMD(add_epi64)(total[c], x86_widened(acc[c][d], d));
			}
		}
	}
}

static void x86_project(const int16_t *rows, int count, int stride,
			const struct kernel_vector vector_of[3], int64_t (*y)[3])
{
	struct kernel_planes planes;
	int64_t lanes[sizeof(vector) / 8];
	vector total[3];

	kernel_planes_fill(&planes, vector_of);
	for (int j = 0; j < count; j++, rows += stride) {
		y[j][0] = y[j][1] = y[j][2] = 0;
		for (int d = 0; d < planes.digits; d += 2) {
			if (planes.digits - d >= 2)
				x86_row_of(rows, stride, &planes, d, total, 2);
			else
				x86_row_of(rows, stride, &planes, d, total, 1);
			KERNEL_UNROLL
			for (int c = 0; c < 3; c++) {
				uint64_t sum = 0;

				STORE(lanes, total[c]);
				for (size_t i = 0; i < sizeof(vector) / 8; i++)
					sum += (uint64_t)lanes[i];
				y[j][c] = (int64_t)((uint64_t)y[j][c] +
						    (sum << d * KERNEL_DIGIT_BITS));
			}
		}
	}
}

/* ---- fold ---- */

/*
 * These sets have no arithmetic shift of int64. So 2^b is added to make x non-negative, and
 * subtracted after the logical shift; for n <= b this is exact:
 *     x >> n = ((x + 2^b) >> n) - 2^(b - n)
 */

/* Narrows int64, given as low and high halves, to int32 with saturation; clamps to KERNEL_LIMIT. */
KERNEL_INLINE vector x86_limited(vector low, vector high)
{
	const vector bound = SIMD_BITS(xor)(SIMD(srai_epi32)(high, 31),
					    SIMD(set1_epi32)(INT32_MAX));
	const vector fits = SIMD(cmpeq_epi32)(high, SIMD(srai_epi32)(low, 31));
	const vector x = SIMD(blendv_epi8)(bound, low, fits);

	return SIMD(max_epi32)(SIMD(min_epi32)(x, SIMD(set1_epi32)(KERNEL_LIMIT)),
			       SIMD(set1_epi32)(-KERNEL_LIMIT));
}

/* clamp(round_shift(sum, shift)) of two vectors of int64 */
KERNEL_INLINE vector x86_first_of(const int64_t *sum, __m128i shift, vector half, vector excess)
{
	const vector sign = SIMD(set1_epi64x)(INT64_MIN);
	vector x[2];

	KERNEL_UNROLL
	for (int i = 0; i < 2; i++) {
		x[i] = SIMD(add_epi64)(LOAD(sum + i * DWORDS / 2), half);
		x[i] = SIMD(srl_epi64)(SIMD_BITS(xor)(x[i], sign), shift);
		x[i] = SIMD(sub_epi64)(x[i], excess);
	}
	return IN_ORDER_64(x86_limited(
		SIMD_BITS(castps)(SIMD(shuffle_ps)(AS_FLOAT(x[0]), AS_FLOAT(x[1]), 0x88)),
		SIMD_BITS(castps)(SIMD(shuffle_ps)(AS_FLOAT(x[0]), AS_FLOAT(x[1]), 0xdd))));
}

/* clamp(round_shift(x * factor, shift)). factor_even and factor_odd hold the factors of even and
 * odd lanes of int32, as uint32 in int64. */
KERNEL_INLINE vector x86_scaled(vector x, vector factor_even, vector factor_odd, int shift)
{
	const vector up = SIMD_BITS(xor)(x, SIMD(set1_epi32)(INT32_MIN));
	const vector half = SIMD(set1_epi64x)(INT64_C(1) << (shift - 1));
	vector even = SIMD(add_epi64)(SIMD(mul_epu32)(up, factor_even), half);
	vector odd = SIMD(add_epi64)(SIMD(mul_epu32)(SIMD(srli_epi64)(up, 32), factor_odd), half);

	even = SIMD(sub_epi64)(SIMD(srli_epi64)(even, shift),
			       SIMD(slli_epi64)(factor_even, 31 - shift));
	odd = SIMD(sub_epi64)(SIMD(srli_epi64)(odd, shift),
			      SIMD(slli_epi64)(factor_odd, 31 - shift));
	return x86_limited(SIMD(blend_epi16)(even, SIMD(slli_epi64)(odd, 32), 0xcc),
			   SIMD(blend_epi16)(SIMD(srli_epi64)(even, 32), odd, 0xcc));
}

/* The same for factors up to 1: the result is not larger than x. So only its low 32 bits count, and
 * these do not depend on the bits that are shifted in above. */
KERNEL_INLINE vector x86_scaled_down(vector x, vector factor_even, vector factor_odd, int shift)
{
	const vector half = SIMD(set1_epi64x)(INT64_C(1) << (shift - 1));
	const vector even = SIMD(add_epi64)(SIMD(mul_epi32)(x, factor_even), half);
	const vector odd = SIMD(add_epi64)(SIMD(mul_epi32)(SIMD(srli_epi64)(x, 32), factor_odd),
					   half);

	return SIMD(blend_epi16)(SIMD(srli_epi64)(even, shift), SIMD(slli_epi64)(odd, 32 - shift),
				 0xcc);
}

/* Multiplies by tints. Vectors with a tint above 1 are rare. */
KERNEL_INLINE vector x86_tinted(vector x, const uint16_t *tint)
{
	const vector t = LOAD_WIDE16(tint);
	const vector beyond = SIMD(cmpgt_epi32)(t, SIMD(set1_epi32)(1 << 15));
	const vector even = SIMD_BITS(and)(t, SIMD(set1_epi64x)(UINT32_MAX)),
		     odd = SIMD(srli_epi64)(t, 32);

	return SIMD_BITS(testz)(beyond, beyond) ? x86_scaled_down(x, even, odd, 15)
						: x86_scaled(x, even, odd, 15);
}

/* clamp(a + b), also where the sum overflows int32. */
KERNEL_INLINE vector x86_added(vector a, vector b)
{
	const vector sum = SIMD(add_epi32)(a, b);
	const vector wrong = SIMD_BITS(and)(SIMD_BITS(xor)(a, sum), SIMD_BITS(xor)(b, sum));
	const vector bound = SIMD_BITS(xor)(SIMD(srai_epi32)(a, 31), SIMD(set1_epi32)(INT32_MAX));
	const vector x = SIMD(blendv_epi8)(sum, bound, SIMD(srai_epi32)(wrong, 31));

	return SIMD(max_epi32)(SIMD(min_epi32)(x, SIMD(set1_epi32)(KERNEL_LIMIT)),
			       SIMD(set1_epi32)(-KERNEL_LIMIT));
}

KERNEL_INLINE void x86_fold_vectors(const int64_t *sum, int count, int shift, uint32_t factor,
				    const uint16_t *tint, const int32_t *from, int32_t *to)
{
	const vector half = SIMD(set1_epi64x)(INT64_C(1) << (shift - 1));
	const vector excess = SIMD(set1_epi64x)(INT64_C(1) << (63 - shift));
	const vector f = SIMD(set1_epi64x)(factor);

	for (int p = 0; p < count; p += DWORDS) {
		vector x = x86_first_of(sum + p, _mm_cvtsi32_si128(shift), half, excess);

		if (factor < 1U << 30)
			x = x86_scaled_down(x, f, f, 30);
		else if (factor > 1U << 30)
			x = x86_scaled(x, f, f, 30);
		if (tint)
			x = x86_tinted(x, tint + p);
		STORE(to + p, x86_added(LOAD(from + p), x));
	}
}

static void x86_fold(const int64_t *sum, int count, int shift, uint32_t factor,
		     const uint16_t *tint, const int32_t *from, int32_t *to)
{
	const int whole = count / DWORDS * DWORDS, rest = count - whole;
	int64_t last_sum[DWORDS] = {0};
	uint16_t last_tint[DWORDS] = {0};
	int32_t last_to[DWORDS] = {0};

	x86_fold_vectors(sum, whole, shift, factor, tint, from, to);
	if (!rest)
		return;
	memcpy(last_sum, sum + whole, (size_t)rest * sizeof(*sum));
	memcpy(last_to, from + whole, (size_t)rest * sizeof(*to));
	if (tint)
		memcpy(last_tint, tint + whole, (size_t)rest * sizeof(*tint));
	x86_fold_vectors(last_sum, DWORDS, shift, factor, tint ? last_tint : NULL, last_to,
			 last_to);
	memcpy(to + whole, last_to, (size_t)rest * sizeof(*to));
}

/* ---- tint ---- */

static void x86_tint(int32_t *value, const uint16_t *by, int count)
{
	const int whole = count / DWORDS * DWORDS;

	for (int n = 0; n < whole; n += DWORDS) {
		const vector x = LOAD(value + n), m = LOAD_WIDE16(by + n);
		/* x = 2^15 h + l, as mul_q15() has it */
		const vector of_h = SIMD(mullo_epi32)(SIMD(srai_epi32)(x, 15), m);
		const vector of_l =
			SIMD(mullo_epi32)(SIMD_BITS(and)(x, SIMD(set1_epi32)((1 << 15) - 1)), m);

		STORE(value + n,
		      SIMD(add_epi32)(
			      of_h, SIMD(srli_epi32)(
					    SIMD(add_epi32)(of_l, SIMD(set1_epi32)(1 << 14)), 15)));
	}
	kernel_c_tint(value + whole, by + whole, count - whole);
}
