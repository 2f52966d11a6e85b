/* SPDX-License-Identifier: MIT */
/* Sums and values of lines for AVX-512; part of kernels_avx512.c. */

/* Loads 32 pixels of a line as int16: a line of int16, or half a line of bytes. */
KERNEL_INLINE __m512i avx512_line_of(const void *lines, size_t at, int half, const bool bytes)
{
	const char *from = (const char *)lines + at;

	return bytes ? _mm512_cvtepi8_epi16(_mm256_load_si256((const __m256i *)from + half))
		     : _mm512_load_si512(from);
}

KERNEL_INLINE void avx512_begin(__m512i acc[3][KERNEL_DIGITS][2], const int digits)
{
	KERNEL_UNROLL
	for (int c = 0; c < 3; c++) {
		KERNEL_UNROLL
		for (int d = 0; d < digits; d++)
			acc[c][d][0] = acc[c][d][1] = _mm512_setzero_si512();
	}
}

/*
 * Sums a run of lines, two at a time: pixel p of two lines are interleaved, and one instruction
 * multiplies both and adds. acc[c][d][0] gets pixels 0-3, 8-11, 16-19, 24-27 of 32 and [1] the
 * others, in the order of unpacklo and unpackhi.
 *
 * All channels are summed in one loop, whether they share their lines or are three streams: the
 * processor then prefetches three streams, and a long loop waits less for memory. One stream after
 * the other was a fifth slower on data in memory, with any prefetching. A stream continues from
 * panel to panel of a block: started anew for each panel (406 lines) it was an eighth slower.
 *
 * Bytes are widened to int16 first. The dot product of four bytes needs digits split in two, so
 * twice the products and twice the sums in registers: measured, it is 5 % faster for one digit, 10
 * % slower for two and much slower beyond.
 */
KERNEL_INLINE void avx512_run_of(const void *lines, const struct kernel_weights *w, int from,
				 int to, int half, const bool bytes, const bool shared,
				 const int digits, __m512i acc[3][KERNEL_DIGITS][2])
{
	const int16_t *digit = kernel_digit(w, from, 0, 0);
	__m512i low, high;

	for (int k = from; k < to; k += 2) {
		size_t one = w->line[k] * w->step, next = w->line[k + 1] * w->step;

		KERNEL_UNROLL
		for (int c = 0; c < 3; c++) {
			if (!c || !shared) {
				const __m512i a = avx512_line_of(lines, one, half, bytes);
				const __m512i b = avx512_line_of(lines, next, half, bytes);

				low = _mm512_unpacklo_epi16(a, b);
				high = _mm512_unpackhi_epi16(a, b);
				one += w->channel;
				next += w->channel;
			}
			KERNEL_UNROLL
			for (int d = 0; d < digits; d++, digit += 2) {
				const __m512i pair = _mm512_set1_epi32(kernel_weight_pair(digit));

				acc[c][d][0] = _mm512_dpwssd_epi32(acc[c][d][0], low, pair);
				acc[c][d][1] = _mm512_dpwssd_epi32(acc[c][d][1], high, pair);
				/* Keeps gcc 12 from copying between two sets of sums in each
				 * step. */
				__asm__("" : "+v"(acc[c][d][0]), "+v"(acc[c][d][1]));
			}
		}
	}
}

/* Moves bits 16 and up of acc to `above`, where 1 stands for 65536, so that acc can take another
 * run:
 *     32 * 32767 * 2048 + 65535 < 2^31
 * 2^16 lines make `above` at most 2^26. */
KERNEL_INLINE void avx512_carry(__m512i acc[3][KERNEL_DIGITS][2],
				__m512i above[3][KERNEL_DIGITS][2], const int digits)
{
	KERNEL_UNROLL
	for (int c = 0; c < 3; c++) {
		KERNEL_UNROLL
		for (int d = 0; d < digits; d++) {
			KERNEL_UNROLL
			for (int i = 0; i < 2; i++) {
				above[c][d][i] = _mm512_add_epi32(
					above[c][d][i], _mm512_srai_epi32(acc[c][d][i], 16));
				acc[c][d][i] = _mm512_and_si512(acc[c][d][i],
								_mm512_set1_epi32(0xffff));
			}
		}
	}
}

/* Widens the lower or upper 8 of 16 int32. */
KERNEL_INLINE __m512i avx512_widened(__m512i x, int half)
{
	return _mm512_cvtepi32_epi64(half ? _mm512_extracti64x4_epi64(x, 1)
					  : _mm512_castsi512_si256(x));
}

/* Returns for 8 pixels
 *     sum over d of (acc_d + 65536 above_d) * 4096^d
 * above: NULL if nothing was carried. */
KERNEL_INLINE __m512i avx512_combined(__m512i acc[KERNEL_DIGITS][2],
				      __m512i above[KERNEL_DIGITS][2], int which, int half,
				      const int digits)
{
	__m512i sum = _mm512_setzero_si512();

	KERNEL_UNROLL
	for (int d = digits - 1; d >= 0; d--) {
		sum = _mm512_add_epi64(_mm512_slli_epi64(sum, KERNEL_DIGIT_BITS),
				       avx512_widened(acc[d][which], half));
		if (above)
			sum = _mm512_add_epi64(
				sum, _mm512_slli_epi64(avx512_widened(above[d][which], half), 16));
	}
	return sum;
}

KERNEL_INLINE void avx512_add_to(int64_t *sum, __m512i more, __m128i shift, __mmask8 old)
{
	const __m512i before = _mm512_maskz_loadu_epi64(old, sum);

	_mm512_storeu_si512(sum, _mm512_add_epi64(before, _mm512_sll_epi64(more, shift)));
}

/* Whether nearly all lines are consecutive: the processor prefetches these by itself. */
KERNEL_INLINE bool avx512_is_stream(const struct kernel_weights *w)
{
	const uint32_t across = w->line[w->count - 2] - w->line[0];

	return w->step == KERNEL_LINE_BYTES && across < 2 * (uint32_t)w->count;
}

/* Computes the sums of 32 pixels. many: in more than one run. */
KERNEL_INLINE void avx512_half_of(const void *lines, const struct kernel_weights *w, int half,
				  int64_t *const *sum, const bool bytes, const bool shared,
				  const int digits, const bool many)
{
	const __m128i shift = _mm_cvtsi32_si128(w->shift);
	const __mmask8 old = w->fresh ? 0 : 0xff;
	const bool stream = many && avx512_is_stream(w);
	__m512i acc[3][KERNEL_DIGITS][2], above[3][KERNEL_DIGITS][2];
	int k = 0;

	avx512_begin(acc, digits);
	if (many)
		avx512_begin(above, digits);
	do {
		const int end = kernel_run_end(w, k, bytes);

		for (int c = 0; c < (shared ? 1 : 3) && many && !stream; c++)
			kernel_fetch((const char *)lines + (size_t)c * w->channel, w, end,
				     kernel_run_end(w, end, bytes));
		avx512_run_of(lines, w, k, end, half, bytes, shared, digits, acc);
		if (many)
			avx512_carry(acc, above, digits);
		k = end;
	} while (many && k < w->count);
	KERNEL_UNROLL
	for (int c = 0; c < 3; c++) {
		KERNEL_UNROLL
		for (int i = 0; i < 2; i++) { /* 0-3, 8-11 and 4-7, 12-15 to memory order */
			const __m512i low = avx512_combined(acc[c], many ? above[c] : NULL, 0, i,
							    digits);
			const __m512i high = avx512_combined(acc[c], many ? above[c] : NULL, 1, i,
							     digits);
			int64_t *to = sum[c] + 32 * half + 16 * i;

			avx512_add_to(to, _mm512_shuffle_i64x2(low, high, 0x44), shift, old);
			avx512_add_to(to + 8, _mm512_shuffle_i64x2(low, high, 0xee), shift, old);
		}
	}
}

KERNEL_INLINE void avx512_pixels_of(const void *lines, const struct kernel_weights *w,
				    int64_t *const *sum, const bool bytes, const bool shared,
				    const int digits)
{
	const int run = bytes ? KERNEL_RUN8 : KERNEL_RUN;

	for (int half = 0; half < 1 + bytes; half++) {
		if (w->count <= run)
			avx512_half_of(lines, w, half, sum, bytes, shared, digits, false);
		else
			avx512_half_of(lines, w, half, sum, bytes, shared, digits, true);
	}
}

KERNEL_INLINE void avx512_sums_of(const void *lines, const struct kernel_weights *w,
				  int64_t *const *sum, const bool bytes, const bool shared)
{
	switch (w->digits) {
	case 1:
		avx512_pixels_of(lines, w, sum, bytes, shared, 1);
		break;
	case 2:
		avx512_pixels_of(lines, w, sum, bytes, shared, 2);
		break;
	case 3:
		avx512_pixels_of(lines, w, sum, bytes, shared, 3);
		break;
	default:
		avx512_pixels_of(lines, w, sum, bytes, shared, 4);
		break;
	}
}

static void avx512_sums16(const int16_t *lines, const struct kernel_weights *w,
			  int64_t *const sum[3])
{
	if (w->channel)
		avx512_sums_of(lines, w, sum, false, false);
	else
		avx512_sums_of(lines, w, sum, false, true);
}

static void avx512_sums8(const int8_t *lines, const struct kernel_weights *w, int64_t *const sum[3])
{
	if (w->channel)
		avx512_sums_of(lines, w, sum, true, false);
	else
		avx512_sums_of(lines, w, sum, true, true);
}

/* ---- values ---- */

/* Returns the sum over d of acc_d * 4096^d, rounded and shifted down, modulo 2^32. Adding the half
 * does not overflow acc_0: 32 * 32767 * 2048 + 2048 < 2^31. */
KERNEL_INLINE __m512i avx512_value_of(__m512i acc[KERNEL_DIGITS][2], int which, const bool bytes,
				      const int digits)
{
	const int down = bytes ? KERNEL_VALUE_SHIFT8 : KERNEL_VALUE_SHIFT16;
	__m512i x = _mm512_srai_epi32(
		_mm512_add_epi32(acc[0][which], _mm512_set1_epi32(1 << (down - 1))),
		(unsigned)down);

	KERNEL_UNROLL
	for (int d = 1; d < digits; d++)
		x = _mm512_add_epi32(
			x,
			_mm512_slli_epi32(acc[d][which], (unsigned)(d * KERNEL_DIGIT_BITS - down)));
	return x;
}

KERNEL_INLINE void avx512_add_values(int32_t *value, __m512i more, __mmask16 old)
{
	const __m512i before = _mm512_maskz_loadu_epi32(old, value);

	_mm512_storeu_si512(value, _mm512_add_epi32(before, more));
}

KERNEL_INLINE void avx512_values_of(const void *lines, const struct kernel_weights *w,
				    int32_t *const *value, const bool bytes, const bool shared,
				    const int digits)
{
	/* Permutations from the order of unpacklo and unpackhi to memory order. */
	const __m512i lower = _mm512_set_epi64(11, 10, 3, 2, 9, 8, 1, 0);
	const __m512i upper = _mm512_set_epi64(15, 14, 7, 6, 13, 12, 5, 4);
	const __mmask16 old = w->fresh ? 0 : 0xffff;
	__m512i acc[3][KERNEL_DIGITS][2];

	for (int half = 0; half < 1 + bytes; half++) {
		avx512_begin(acc, digits);
		avx512_run_of(lines, w, 0, w->count, half, bytes, shared, digits, acc);
		KERNEL_UNROLL
		for (int c = 0; c < 3; c++) {
			const __m512i a = avx512_value_of(acc[c], 0, bytes, digits);
			const __m512i b = avx512_value_of(acc[c], 1, bytes, digits);
			int32_t *to = value[c] + 32 * half;

			avx512_add_values(to, _mm512_permutex2var_epi64(a, lower, b), old);
			avx512_add_values(to + 16, _mm512_permutex2var_epi64(a, upper, b), old);
		}
	}
}

KERNEL_INLINE void avx512_values(const void *lines, const struct kernel_weights *w,
				 int32_t *const *value, const bool bytes, const bool shared)
{
	switch (w->digits) {
	case 1:
		avx512_values_of(lines, w, value, bytes, shared, 1);
		break;
	case 2:
		avx512_values_of(lines, w, value, bytes, shared, 2);
		break;
	case 3:
		avx512_values_of(lines, w, value, bytes, shared, 3);
		break;
	default:
		avx512_values_of(lines, w, value, bytes, shared, 4);
		break;
	}
}

static void avx512_values16(const int16_t *lines, const struct kernel_weights *w,
			    int32_t *const value[3])
{
	if (w->channel)
		avx512_values(lines, w, value, false, false);
	else
		avx512_values(lines, w, value, false, true);
}

static void avx512_values8(const int8_t *lines, const struct kernel_weights *w,
			   int32_t *const value[3])
{
	if (w->channel)
		avx512_values(lines, w, value, true, false);
	else
		avx512_values(lines, w, value, true, true);
}
