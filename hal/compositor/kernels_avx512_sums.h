/* sums16 and sums8 for AVX-512; part of kernels_avx512.c. */

/* What is added up at once: one channel or all three; and whether these read the same lines. */
struct form {
	int channels;
	bool shared;
};

/* 32 pixels of a line as int16: all of it, or a half of a line of bytes. */
KERNEL_INLINE __m512i line_of(const void *lines, size_t at, int half, const bool bytes)
{
	const char *from = (const char *)lines + at;

	return bytes ? _mm512_cvtepi8_epi16(_mm256_load_si256((const __m256i *)from + half))
		     : _mm512_load_si512(from);
}

/*
 * How many bytes ahead of lines that nearly all follow each other to ask for more, past the ends of
 * pages and panels, which the processor does not cross by itself; 0 where they are too few, or lie
 * apart. Measured: half as far is slower, and so is asking for a run at once.
 */
KERNEL_INLINE size_t stream_ahead(const struct kernel_weights *w)
{
	const uint32_t across = w->line[w->count - 2] - w->line[0];

	return w->count > KERNEL_RUN && w->step == KERNEL_LINE_BYTES &&
			       across < 2 * (uint32_t)w->count
		       ? (size_t)128 * KERNEL_LINE_BYTES
		       : 0;
}

/*
 * A run of lines, two at a time, side by side: p of one and p of the next are multiplied and added
 * by one instruction. acc[c][d][0] gets pixels 0-3, 8-11, 16-19, 24-27 of 32 and [1] the others, as
 * unpacking leaves them.
 *
 * Bytes go the same way, once they are int16. The dot product of four bytes takes more: digits must
 * be split in two for it, so there are twice the products and twice the sums in registers;
 * measured, it is a twentieth faster for one digit, a tenth slower for two and far slower beyond.
 */
KERNEL_INLINE void run_of(const void *lines, const struct kernel_weights *w, int from, int to,
			  int first, int half, size_t ahead, const bool bytes,
			  const struct form form, const int digits,
			  __m512i acc[3][KERNEL_DIGITS][2])
{
	const int16_t *digit = kernel_digit(w, from, first, 0);
	__m512i low, high;

	KERNEL_UNROLL
	for (int c = 0; c < form.channels; c++) {
		KERNEL_UNROLL
		for (int d = 0; d < digits; d++) {
			acc[c][d][0] = acc[c][d][1] = _mm512_setzero_si512();
			/* Where there are many, gcc 12 is not to know that they are 0: it would
			 * make a second set of sums for the first two lines, and move one to the
			 * other in every step. */
			if (form.channels == 3)
				__asm__("" : "+v"(acc[c][d][0]), "+v"(acc[c][d][1]));
		}
	}
	for (int k = from; k < to; k += 2) {
		size_t one = w->line[k] * w->step, next = w->line[k + 1] * w->step;

		if (form.channels == 1 && ahead) { /* not to stay in caches that it passes */
			__builtin_prefetch((const char *)lines + one + ahead, 0, 0);
			__builtin_prefetch((const char *)lines + next + ahead, 0, 0);
		}
		KERNEL_UNROLL
		for (int c = 0; c < form.channels; c++) {
			if (!c || !form.shared) {
				const __m512i a = line_of(lines, one, half, bytes);
				const __m512i b = line_of(lines, next, half, bytes);

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
			}
		}
		digit += (3 - form.channels) * digits * 2;
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

KERNEL_INLINE void add_to(int64_t *sum, __m512i more, __m128i shift, __mmask8 old)
{
	const __m512i before = _mm512_maskz_loadu_epi64(old, sum);

	_mm512_storeu_si512(sum, _mm512_add_epi64(before, _mm512_sll_epi64(more, shift)));
}

/* The sums of 32 pixels, of one channel or of all. */
KERNEL_INLINE void half_of(const void *lines, const struct kernel_weights *w, int first, int half,
			   int64_t *const *sum, const bool bytes, const struct form form,
			   const int digits)
{
	const __m128i shift = _mm_cvtsi32_si128(w->shift);
	const size_t ahead = form.channels == 1 ? stream_ahead(w) : 0;
	__m512i acc[3][KERNEL_DIGITS][2];
	__mmask8 old = w->fresh ? 0 : 0xff;
	int k = 0;

	lines = (const char *)lines + (size_t)first * w->channel;
	do {
		const int end = kernel_run_end(w, k, bytes);

		if (!ahead)
			kernel_fetch(lines, w, end, kernel_run_end(w, end, bytes));
		run_of(lines, w, k, end, first, half, ahead, bytes, form, digits, acc);
		KERNEL_UNROLL
		for (int c = 0; c < form.channels; c++) {
			KERNEL_UNROLL
			for (int i = 0; i < 2; i++) { /* 0-3, 8-11 and 4-7, 12-15 into order */
				const __m512i low = combined(acc[c], 0, i, digits);
				const __m512i high = combined(acc[c], 1, i, digits);
				int64_t *to = sum[first + c] + 32 * half + 16 * i;

				add_to(to, _mm512_shuffle_i64x2(low, high, 0x44), shift, old);
				add_to(to + 8, _mm512_shuffle_i64x2(low, high, 0xee), shift, old);
			}
		}
		old = 0xff;
		k = end;
	} while (k < w->count);
}

KERNEL_INLINE void channels_of(const void *lines, const struct kernel_weights *w, int first,
			       int64_t *const *sum, const bool bytes, const struct form form)
{
	for (int half = 0; half < 1 + bytes; half++) {
		switch (w->digits) {
		case 1:
			half_of(lines, w, first, half, sum, bytes, form, 1);
			break;
		case 2:
			half_of(lines, w, first, half, sum, bytes, form, 2);
			break;
		case 3:
			half_of(lines, w, first, half, sum, bytes, form, 3);
			break;
		default:
			half_of(lines, w, first, half, sum, bytes, form, 4);
			break;
		}
	}
}

/* Many lines that lie by channels are a stream each, and faster one after the other. */
KERNEL_INLINE void sums_of(const void *lines, const struct kernel_weights *w, int64_t *const *sum,
			   const bool bytes)
{
	if (!w->channel) {
		channels_of(lines, w, 0, sum, bytes, (struct form){3, true});
	} else if (w->count <= KERNEL_RUN) {
		channels_of(lines, w, 0, sum, bytes, (struct form){3, false});
	} else {
		for (int c = 0; c < 3; c++)
			channels_of(lines, w, c, sum, bytes, (struct form){1, false});
	}
}

static void sums16(const int16_t *lines, const struct kernel_weights *w, int64_t *const sum[3])
{
	sums_of(lines, w, sum, false);
}

static void sums8(const int8_t *lines, const struct kernel_weights *w, int64_t *const sum[3])
{
	sums_of(lines, w, sum, true);
}
