/* SPDX-License-Identifier: MIT */
#include "hal/compositor/kernels/kernels_grain.h"
#include "hal/compositor/kernels/kernels_neon.h"

/*
 * Only lines of bytes gain from the dot product. It multiplies four adjacent bytes, here one pixel
 * of four lines, by four weights of one byte. A digit is split in two:
 *     digit = 256 h + l,  -8 <= h <= 8,  -128 <= l <= 127
 * |x l| <= 127 * 128, so a piece of 256 lines adds up in int32.
 *
 * Values of int16 would have to be split as well, which means four products instead of one.
 */
#define PIECE 256 /* lines that stay in the first-level cache while all pixels are summed */
#define PIXELS 16 /* at a time: 8 or 16 vectors of sums for two halves of one or two digits */

/* Splits four digits, given as two pairs: l of all four, then h of all four. */
KERNEL_INLINE int8x8_t dotprod_split_of(int32_t first, int32_t second)
{
	const int16x4_t x = vreinterpret_s16_s32((int32x2_t){first, second});
	const int16x4_t h = vshr_n_s16(vadd_s16(x, vdup_n_s16(128)), 8);

	return vuzp1_s8(vreinterpret_s8_s16(x), vreinterpret_s8_s16(h));
}

/* Interleaves four lines: quad[i] holds pixels 4i..4i+3, four bytes each. */
KERNEL_INLINE void dotprod_quads_of(const int8_t *lines, const size_t at[4], int p,
				    int8x16_t quad[4])
{
	int8x16_t x[4];
	int16x8_t low[2], high[2];

	KERNEL_UNROLL
	for (int i = 0; i < 4; i++)
		x[i] = vld1q_s8(lines + at[i] + p);
	KERNEL_UNROLL
	for (int i = 0; i < 2; i++) {
		low[i] = vreinterpretq_s16_s8(vzip1q_s8(x[2 * i], x[2 * i + 1]));
		high[i] = vreinterpretq_s16_s8(vzip2q_s8(x[2 * i], x[2 * i + 1]));
	}
	quad[0] = vreinterpretq_s8_s16(vzip1q_s16(low[0], low[1]));
	quad[1] = vreinterpretq_s8_s16(vzip2q_s16(low[0], low[1]));
	quad[2] = vreinterpretq_s8_s16(vzip1q_s16(high[0], high[1]));
	quad[3] = vreinterpretq_s8_s16(vzip2q_s16(high[0], high[1]));
}

/* sum[0..3] += (l + 256 h) * 2^shift, modulo 2^64 */
KERNEL_INLINE void dotprod_add_to(int64_t *sum, int32x4_t l, int32x4_t h, int64x2_t shift)
{
	const int64x2_t a = vaddw_s32(vshll_n_s32(vget_low_s32(h), 8), vget_low_s32(l));
	const int64x2_t b = vaddw_high_s32(vshll_high_n_s32(h, 8), l);

	vst1q_s64(sum, vaddq_s64(vld1q_s64(sum), vshlq_s64(a, shift)));
	vst1q_s64(sum + 2, vaddq_s64(vld1q_s64(sum + 2), vshlq_s64(b, shift)));
}

KERNEL_INLINE void dotprod_run8(const int8_t *lines, const struct kernel_weights *w, int c,
				int first, int from, int to, int p, int64_t *sum, const int digits)
{
	int32x4_t low[2][4], high[2][4];
	int8x16_t quad[4];

	KERNEL_UNROLL
	for (int i = 0; i < 4; i++)
		low[0][i] = high[0][i] = low[1][i] = high[1][i] = vdupq_n_s32(0);
	for (int k = from; k < to; k += 4) {
		const uint32_t *l = w->line + k;
		/* If only two lines are left, they are read again, with weights of 0. */
		const int other = to - k > 2 ? 2 : 0;
		const size_t at[4] = {l[0] * w->step, l[1] * w->step, l[other] * w->step,
				      l[other + 1] * w->step};

		dotprod_quads_of(lines, at, p, quad);
		KERNEL_UNROLL
		for (int d = 0; d < digits; d++) {
			const int16_t *digit = kernel_digit(w, k, c, first + d);
			const int8x8_t split = dotprod_split_of(
				kernel_weight_pair(digit),
				other ? kernel_weight_pair(kernel_digit(w, k + 2, c, first + d))
				      : 0);

			KERNEL_UNROLL
			for (int i = 0; i < 4; i++) {
				low[d][i] = vdotq_lane_s32(low[d][i], quad[i], split, 0);
				high[d][i] = vdotq_lane_s32(high[d][i], quad[i], split, 1);
			}
		}
	}
	KERNEL_UNROLL
	for (int d = 0; d < digits; d++) {
		const int64x2_t shift = vdupq_n_s64(w->shift + (first + d) * KERNEL_DIGIT_BITS);

		KERNEL_UNROLL
		for (int i = 0; i < 4; i++)
			dotprod_add_to(sum + p + 4 * i, low[d][i], high[d][i], shift);
	}
}

KERNEL_INLINE void dotprod_piece8(const int8_t *lines, const struct kernel_weights *w, int c,
				  int from, int to, int p, int64_t *sum)
{
	lines += (size_t)c * w->channel;
	for (int d = 0; d < w->digits; d += 2) {
		if (w->digits - d >= 2)
			dotprod_run8(lines, w, c, d, from, to, p, sum, 2);
		else
			dotprod_run8(lines, w, c, d, from, to, p, sum, 1);
	}
}

static void dotprod_sums8(const int8_t *lines, const struct kernel_weights *w,
			  int64_t *const sum[3])
{
	kernel_begin(w, sum, KERNEL_LINE8);
	for (int k = 0; k < w->count; k += PIECE) {
		const int end = w->count - k > PIECE ? k + PIECE : w->count;

		kernel_fetch(lines, w, k, end);
		for (int p = 0; p < KERNEL_LINE8; p += PIXELS) {
			for (int c = 0; c < 3; c++)
				dotprod_piece8(lines, w, c, k, end, p, sum[c]);
		}
	}
}

/* All but sums8 is borrowed: kernel_neon_*() from kernels_neon.c, kernel_c_*() from kernels_c.c. */
const struct kernels kernels_neon_dotprod = {
	.name = "neon-dotprod",
	.supported = kernels_supported_neon_dotprod,
	.sums16 = kernel_neon_sums16,
	.sums8 = dotprod_sums8,
	.values16 = kernel_neon_values16,
	.values8 = kernel_neon_values8,
	.split = kernel_c_split,
	.project = kernel_neon_project,
	.fold = kernel_neon_fold,
	.tint = kernel_neon_tint,
	.place = kernel_c_place,
	.mix = kernel_neon_mix,
	.grain = kernel_add_grain,
	.divide = kernel_divide,
};
