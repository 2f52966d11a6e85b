/* SPDX-License-Identifier: MIT */
#include "hal/compositor/kernels/kernels_neon.h"
#include "hal/compositor/kernels/kernels_grain.h"

/* ---- sums16, sums8 ---- */

/* Loads 32 pixels of a line in order: the widening multiply-add needs no pairs of lines. Its sums
 * stay below 2^31 for a run of KERNEL_RUN lines. */
KERNEL_INLINE void neon_line_of(const void *lines, size_t at, int p, const bool bytes,
				int16x8_t x[4])
{
	if (bytes) {
		const int8_t *from = (const int8_t *)lines + at + p;
		const int8x16_t low = vld1q_s8(from), high = vld1q_s8(from + 16);

		x[0] = vmovl_s8(vget_low_s8(low));
		x[1] = vmovl_s8(vget_high_s8(low));
		x[2] = vmovl_s8(vget_low_s8(high));
		x[3] = vmovl_s8(vget_high_s8(high));
	} else {
		const int16_t *from = (const int16_t *)lines + at / sizeof(int16_t) + p;

		KERNEL_UNROLL
		for (int i = 0; i < 4; i++)
			x[i] = vld1q_s16(from + 8 * i);
	}
}

/* sum[0..3] += (part[0] + part[1] * 4096) * 2^shift, modulo 2^64 */
KERNEL_INLINE void neon_add_to(int64_t *sum, const int32x4_t part[2], int64x2_t shift,
			       const int digits)
{
	int64x2_t low = vmovl_s32(vget_low_s32(part[0])), high = vmovl_high_s32(part[0]);

	if (digits == 2) {
		low = vaddq_s64(low, vshll_n_s32(vget_low_s32(part[1]), KERNEL_DIGIT_BITS));
		high = vaddq_s64(high, vshll_high_n_s32(part[1], KERNEL_DIGIT_BITS));
	}
	vst1q_s64(sum, vaddq_s64(vld1q_s64(sum), vshlq_s64(low, shift)));
	vst1q_s64(sum + 2, vaddq_s64(vld1q_s64(sum + 2), vshlq_s64(high, shift)));
}

/* Sums a run of lines for 32 pixels of a channel and one or two digits, in 8 or 16 vectors of four.
 * */
KERNEL_INLINE void neon_add_run(const void *lines, const struct kernel_weights *w, int c, int first,
				int from, int to, int p, const bool bytes, const int digits,
				int32x4_t part[8][2])
{
	int16x8_t x[4];

	KERNEL_UNROLL
	for (int i = 0; i < 8; i++)
		part[i][0] = part[i][1] = vdupq_n_s32(0);
	for (int k = from; k < to; k++) {
		neon_line_of(lines, w->line[k] * w->step, p, bytes, x);
		KERNEL_UNROLL
		for (int d = 0; d < digits; d++) {
			const int16x8_t weight = vld1q_dup_s16(kernel_digit(w, k, c, first + d));

			KERNEL_UNROLL
			for (int i = 0; i < 4; i++) {
				part[2 * i][d] = vmlal_s16(part[2 * i][d], vget_low_s16(x[i]),
							   vget_low_s16(weight));
				part[2 * i + 1][d] = vmlal_high_s16(part[2 * i + 1][d], x[i],
								    weight);
			}
		}
	}
}

KERNEL_INLINE void neon_run_of(const void *lines, const struct kernel_weights *w, int c, int first,
			       int from, int to, int p, int64_t *sum, const bool bytes,
			       const int digits)
{
	const int64x2_t shift = vdupq_n_s64(w->shift + first * KERNEL_DIGIT_BITS);
	int32x4_t part[8][2];

	neon_add_run(lines, w, c, first, from, to, p, bytes, digits, part);
	KERNEL_UNROLL
	for (int i = 0; i < 8; i++)
		neon_add_to(sum + p + 4 * i, part[i], shift, digits);
}

KERNEL_INLINE void neon_channel_of(const void *lines, const struct kernel_weights *w, int c,
				   int from, int to, int p, int64_t *sum, const bool bytes)
{
	lines = (const char *)lines + (size_t)c * w->channel;
	for (int d = 0; d < w->digits; d += 2) {
		if (w->digits - d >= 2)
			neon_run_of(lines, w, c, d, from, to, p, sum, bytes, 2);
		else
			neon_run_of(lines, w, c, d, from, to, p, sum, bytes, 1);
	}
}

KERNEL_INLINE void neon_sums(const void *lines, const struct kernel_weights *w,
			     int64_t *const sum[3], const bool bytes)
{
	const int pixels = bytes ? KERNEL_LINE8 : KERNEL_LINE16;

	kernel_begin(w, sum, pixels);
	for (int k = 0, end; k < w->count; k = end) {
		end = kernel_run_end(w, k, bytes);
		kernel_fetch(lines, w, end, kernel_run_end(w, end, bytes));
		for (int p = 0; p < pixels; p += 32) {
			for (int c = 0; c < 3; c++)
				neon_channel_of(lines, w, c, k, end, p, sum[c], bytes);
		}
	}
}

void kernel_neon_sums16(const int16_t *lines, const struct kernel_weights *w, int64_t *const sum[3])
{
	neon_sums(lines, w, sum, false);
}

static void kernel_neon_sums8(const int8_t *lines, const struct kernel_weights *w,
			      int64_t *const sum[3])
{
	neon_sums(lines, w, sum, true);
}

/* ---- values16, values8 ---- */

/* Returns (part[0] + 4096 part[1]) * 4096^first, rounded and shifted down, modulo 2^32. vrshlq by a
 * negative number rounds without overflow; shifts by 32 or more give 0. */
KERNEL_INLINE int32x4_t neon_value_of(const int32x4_t part[2], const bool bytes, const int first,
				      const int digits)
{
	const int down = bytes ? KERNEL_VALUE_SHIFT8 : KERNEL_VALUE_SHIFT16;
	const int up = first * KERNEL_DIGIT_BITS - down;
	const int32x4_t x = vrshlq_s32(part[0], vdupq_n_s32(up));

	return digits == 2 ? vaddq_s32(x, vshlq_s32(part[1], vdupq_n_s32(up + KERNEL_DIGIT_BITS)))
			   : x;
}

KERNEL_INLINE void neon_value_run(const void *lines, const struct kernel_weights *w, int c, int p,
				  int32_t *value, const bool bytes, const int first,
				  const int digits)
{
	const bool old = first || !w->fresh;
	int32x4_t part[8][2];

	neon_add_run(lines, w, c, first, 0, w->count, p, bytes, digits, part);
	KERNEL_UNROLL
	for (int i = 0; i < 8; i++) {
		int32_t *to = value + p + 4 * i;
		const int32x4_t more = neon_value_of(part[i], bytes, first, digits);

		vst1q_s32(to, old ? vaddq_s32(vld1q_s32(to), more) : more);
	}
}

KERNEL_INLINE void neon_values(const void *lines, const struct kernel_weights *w,
			       int32_t *const value[3], const bool bytes)
{
	const int pixels = bytes ? KERNEL_LINE8 : KERNEL_LINE16;

	for (int c = 0; c < 3; c++) {
		const char *from = (const char *)lines + (size_t)c * w->channel;

		for (int p = 0; p < pixels; p += 32) {
			if (w->digits >= 2)
				neon_value_run(from, w, c, p, value[c], bytes, 0, 2);
			else
				neon_value_run(from, w, c, p, value[c], bytes, 0, 1);
			if (w->digits == 4)
				neon_value_run(from, w, c, p, value[c], bytes, 2, 2);
			else if (w->digits == 3)
				neon_value_run(from, w, c, p, value[c], bytes, 2, 1);
		}
	}
}

void kernel_neon_values16(const int16_t *lines, const struct kernel_weights *w,
			  int32_t *const value[3])
{
	neon_values(lines, w, value, false);
}

void kernel_neon_values8(const int8_t *lines, const struct kernel_weights *w,
			 int32_t *const value[3])
{
	neon_values(lines, w, value, true);
}

/* ---- project ---- */

/* Values of a row until each lane of int32 holds 32 products, two from each 8 values. */
#define ROW_RUN (4 * KERNEL_LANE_PRODUCTS)

/* Multiplies one row with one or two digits of all channels, in int64. */
KERNEL_INLINE void neon_row_of(const int16_t *row, int stride, const struct kernel_planes *planes,
			       int first, int64x2_t total[3][2], const int digits)
{
	KERNEL_UNROLL
	for (int c = 0; c < 3; c++)
		total[c][0] = total[c][1] = vdupq_n_s64(0);
	for (int from = 0; from < stride; from += ROW_RUN) {
		const int to = stride - from > ROW_RUN ? from + ROW_RUN : stride;
		int32x4_t part[3][2];

		KERNEL_UNROLL
		for (int c = 0; c < 3; c++)
			part[c][0] = part[c][1] = vdupq_n_s32(0);
		for (int k = from; k < to; k += 8) {
			const int16x8_t x = vld1q_s16(row + k);

			KERNEL_UNROLL
			for (int c = 0; c < 3; c++) {
				KERNEL_UNROLL
				for (int d = 0; d < digits; d++) {
					const int16x8_t v =
						vld1q_s16(planes->plane[c][first + d] + k);

					part[c][d] = vmlal_s16(part[c][d], vget_low_s16(x),
							       vget_low_s16(v));
					part[c][d] = vmlal_high_s16(part[c][d], x, v);
				}
			}
		}
		KERNEL_UNROLL
		for (int c = 0; c < 3; c++) {
			KERNEL_UNROLL
			for (int d = 0; d < digits; d++)
				total[c][d] = vpadalq_s32(total[c][d], part[c][d]);
		}
	}
}

void kernel_neon_project(const int16_t *rows, int count, int stride,
			 const struct kernel_vector vector[3], int64_t (*y)[3])
{
	struct kernel_planes planes;
	int64x2_t total[3][2];

	kernel_planes_fill(&planes, vector);
	for (int j = 0; j < count; j++, rows += stride) {
		y[j][0] = y[j][1] = y[j][2] = 0;
		for (int d = 0; d < planes.digits; d += 2) {
			if (planes.digits - d >= 2)
				neon_row_of(rows, stride, &planes, d, total, 2);
			else
				neon_row_of(rows, stride, &planes, d, total, 1);
			for (int c = 0; c < 3; c++) {
				const uint64_t low = (uint64_t)vaddvq_s64(total[c][0]);
				const uint64_t high = (uint64_t)vaddvq_s64(total[c][1]);
				const uint64_t sum = low + (high << KERNEL_DIGIT_BITS);

				y[j][c] = (int64_t)((uint64_t)y[j][c] +
						    (sum << d * KERNEL_DIGIT_BITS));
			}
		}
	}
}

/* ---- fold ---- */

/* Narrows int64 to int32 with saturation, and clamps to KERNEL_LIMIT. */
KERNEL_INLINE int32x4_t neon_limited(int64x2_t low, int64x2_t high)
{
	const int32x4_t x = vqmovn_high_s64(vqmovn_s64(low), high);

	return vmaxq_s32(vminq_s32(x, vdupq_n_s32(KERNEL_LIMIT)), vdupq_n_s32(-KERNEL_LIMIT));
}

/* clamp(round_shift(x * factor, bits)). The shift by -bits rounds like round_shift(), without
 * overflow. */
KERNEL_INLINE int32x4_t neon_scaled(int32x4_t x, int32x4_t factor, int64x2_t minus_bits)
{
	return neon_limited(
		vrshlq_s64(vmull_s32(vget_low_s32(x), vget_low_s32(factor)), minus_bits),
		vrshlq_s64(vmull_high_s32(x, factor), minus_bits));
}

static void neon_fold4(const int64_t *sum, int shift, uint32_t factor, const uint16_t *tint,
		       const int32_t *from, int32_t *to)
{
	/* The multiplication is signed, and 2^31 does not fit: halve the factor, shift one bit
	 * less. */
	const int whole = factor >> 31 ? 29 : 30;
	const int64x2_t bits = vdupq_n_s64(-shift);
	int32x4_t x = neon_limited(vrshlq_s64(vld1q_s64(sum), bits),
				   vrshlq_s64(vld1q_s64(sum + 2), bits));

	x = neon_scaled(x, vdupq_n_s32((int32_t)(factor >> (30 - whole))), vdupq_n_s64(-whole));
	if (tint) {
		const int32x4_t t = vreinterpretq_s32_u32(vmovl_u16(vld1_u16(tint)));

		x = neon_scaled(x, t, vdupq_n_s64(-15));
	}
	x = vqaddq_s32(vld1q_s32(from), x);
	x = vmaxq_s32(vminq_s32(x, vdupq_n_s32(KERNEL_LIMIT)), vdupq_n_s32(-KERNEL_LIMIT));
	vst1q_s32(to, x);
}

void kernel_neon_fold(const int64_t *sum, int count, int shift, uint32_t factor,
		      const uint16_t *tint, const int32_t *from, int32_t *to)
{
	const int whole = count / 4 * 4;
	const size_t rest = (size_t)(count - whole);
	int64_t last_sum[4] = {0};
	uint16_t last_tint[4] = {0};
	int32_t last_to[4] = {0};

	for (int p = 0; p < whole; p += 4)
		neon_fold4(sum + p, shift, factor, tint ? tint + p : NULL, from + p, to + p);
	if (!rest)
		return;
	memcpy(last_sum, sum + whole, rest * sizeof(*sum));
	memcpy(last_to, from + whole, rest * sizeof(*to));
	if (tint)
		memcpy(last_tint, tint + whole, rest * sizeof(*tint));
	neon_fold4(last_sum, shift, factor, tint ? last_tint : NULL, last_to, last_to);
	memcpy(to + whole, last_to, rest * sizeof(*to));
}

/* ---- tint ---- */

void kernel_neon_tint(int32_t *value, const uint16_t *by, int count)
{
	const int whole = count / 4 * 4;

	for (int n = 0; n < whole; n += 4) {
		const int32x4_t x = vld1q_s32(value + n);
		const int32x4_t m = vreinterpretq_s32_u32(vmovl_u16(vld1_u16(by + n)));
		const int32x2_t low = vrshrn_n_s64(vmull_s32(vget_low_s32(x), vget_low_s32(m)), 15);

		vst1q_s32(value + n, vrshrn_high_n_s64(low, vmull_high_s32(x, m), 15));
	}
	kernel_c_tint(value + whole, by + whole, count - whole);
}

/* ---- mix ---- */

/* Low and high bytes of a, b, c. One instruction looks up in 32 bytes. */
struct neon_tables {
	uint8x16x2_t byte[6];
};

/* Looks up the words of 16 pieces. */
KERNEL_INLINE void neon_looked_up(const struct neon_tables *k, int which, uint8x16_t piece,
				  int16x8_t word[2])
{
	const uint8x16_t low = vqtbl2q_u8(k->byte[2 * which], piece);
	const uint8x16_t high = vqtbl2q_u8(k->byte[2 * which + 1], piece);

	word[0] = vreinterpretq_s16_u8(vzip1q_u8(low, high));
	word[1] = vreinterpretq_s16_u8(vzip2q_u8(low, high));
}

/* Encodes 16 keys to 16 codes. t is even, so the doubling multiplication by t / 2 is exact. */
KERNEL_INLINE uint8x16_t neon_encoded(const struct neon_tables *k, uint16x8_t key0, uint16x8_t key1)
{
	const uint16x8_t key[2] = {key0, key1};
	const uint8x16_t piece = vshrn_high_n_u16(vshrn_n_u16(key0, 8), key1, 8);
	int16x8_t a[2], b[2], c[2];
	uint8x8_t code[2];

	neon_looked_up(k, 0, vshrq_n_u8(piece, 3), a);
	neon_looked_up(k, 1, vshrq_n_u8(piece, 3), b);
	neon_looked_up(k, 2, vshrq_n_u8(piece, 3), c);
	KERNEL_UNROLL
	for (int i = 0; i < 2; i++) {
		const int16x8_t t = vreinterpretq_s16_u16(vshrq_n_u16(vshlq_n_u16(key[i], 5), 2));
		const int16x8_t slope = vaddq_s16(b[i], vqdmulhq_s16(c[i], t));
		const int16x8_t sum = vaddq_s16(a[i], vqdmulhq_s16(slope, t));

		code[i] = vshrn_n_u16(vreinterpretq_u16_s16(sum), 8);
	}
	return vcombine_u8(code[0], code[1]);
}

KERNEL_INLINE float32x4_t neon_left_of(const uint16_t *coverage)
{
	const uint32x4_t a = vmovl_u16(vld1_u16(coverage));
	const uint32x4_t rest = vsubq_u32(vsubq_u32(vdupq_n_u32(65536), a), vshrq_n_u32(a, 15));

	return vmulq_n_f32(vcvtq_f32_u32(rest), KERNEL_WHITE / 65535 / 65536);
}

/* Four keys of a channel; narrowing to words clamps them to 0..65535. */
KERNEL_INLINE uint16x4_t neon_keys_of(const struct kernel_row *row, int c, int x, float32x4_t left,
				      const bool bare)
{
	const uint8_t *in = row->background + (size_t)x * 4 + 2 - c;
	const float *linear = row->curves->linear;
	const float32x4_t b = {linear[in[0]], linear[in[4]], linear[in[8]], linear[in[12]]};
	const float32x4_t taken = vcvtq_f32_s32(vld1q_s32(row->taken[c] + x));
	float32x4_t ratio = vsubq_f32(vdupq_n_f32(1.0f), vmulq_n_f32(taken, 0x1p-24f));
	float32x4_t raised = vdupq_n_f32(KERNEL_BLACK), v;

	if (!bare) {
		const float32x4_t object = vcvtq_f32_s32(vld1q_s32(row->object[c] + x));

		raised = vaddq_f32(vmulq_n_f32(object, KERNEL_WHITE * 0x1p-24f), raised);
	}
	ratio = vminq_f32(vmaxq_f32(ratio, vdupq_n_f32(0.0f)), vdupq_n_f32(16.0f));
	v = vaddq_f32(vmulq_f32(vmulq_f32(ratio, left), b), raised);
	return vqmovun_s32(
		vsubq_s32(vshrq_n_s32(vreinterpretq_s32_f32(v), 10), vdupq_n_s32(KERNEL_KEY_BASE)));
}

KERNEL_INLINE void neon_mix16(const struct kernel_row *row, const struct neon_tables *k, int x,
			      const bool bare)
{
	uint16x4_t key[3][4];
	uint8x16x4_t out;

	KERNEL_UNROLL
	for (int i = 0; i < 4; i++) {
		const float32x4_t left = bare ? vdupq_n_f32(KERNEL_WHITE / 65535)
					      : neon_left_of(row->coverage + x + 4 * i);

		KERNEL_UNROLL
		for (int c = 0; c < 3; c++)
			key[c][i] = neon_keys_of(row, c, x + 4 * i, left, bare);
	}
	KERNEL_UNROLL
	for (int c = 0; c < 3; c++)
		out.val[2 - c] = neon_encoded(k, vcombine_u16(key[c][0], key[c][1]),
					      vcombine_u16(key[c][2], key[c][3]));
	out.val[3] = vdupq_n_u8(255);
	vst4q_u8(row->out + (size_t)x * 4, out);
}

KERNEL_INLINE void neon_mix_row(const struct kernel_row *row, const struct neon_tables *k,
				const bool bare)
{
	int x = 0;

	for (; x + 16 <= row->count; x += 16)
		neon_mix16(row, k, x, bare);
	if (x < row->count) {
		struct kernel_rest rest;
		struct kernel_row all;

		kernel_rest_load(&rest, &all, row, x);
		neon_mix16(&all, k, 0, bare);
		memcpy(row->out + (size_t)x * 4, rest.out, (size_t)(row->count - x) * 4);
	}
}

void kernel_neon_mix(const struct kernel_row *rows)
{
	struct kernel_row row = *rows;
	struct neon_tables k;

	KERNEL_UNROLL
	for (int i = 0; i < 6; i++) {
		k.byte[i].val[0] = vld1q_u8(row.curves->bytes[i]);
		k.byte[i].val[1] = vld1q_u8(row.curves->bytes[i] + 16);
	}
	for (int y = 0; y < rows->rows; y++, kernel_row_next(&row))
		if (row.coverage)
			neon_mix_row(&row, &k, false);
		else
			neon_mix_row(&row, &k, true);
}

const struct kernels kernels_neon = {
	.name = "neon",
	.supported = kernels_supported_neon,
	.sums16 = kernel_neon_sums16,
	.sums8 = kernel_neon_sums8,
	.values16 = kernel_neon_values16,
	.values8 = kernel_neon_values8,
	.split = kernel_c_split, /* borrowed from kernels_c.c */
	.project = kernel_neon_project,
	.fold = kernel_neon_fold,
	.tint = kernel_neon_tint,
	.place = kernel_c_place, /* borrowed from kernels_c.c */
	.mix = kernel_neon_mix,
	.grain = kernel_add_grain,
	.divide = kernel_divide,
};
