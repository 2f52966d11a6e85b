/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "hal/compositor/kernels/digits.h"
#include "hal/compositor/kernels/fixed.h"
#include "hal/compositor/kernels/kernels_grain.h"
#include "hal/compositor/kernels/kernels_isa.h"

static bool kernel_c_supported(void)
{
	return true;
}

/* Unsigned, modulo 2^64: partial sums may exceed 2^63. The complete sum does not, so it is exact.
 * */
static void sum_add(int64_t *sum, int64_t more, int shift)
{
	*sum = (int64_t)((uint64_t)*sum + ((uint64_t)more << shift));
}

static void kernel_c_sums16(const int16_t *lines, const struct kernel_weights *w,
			    int64_t *const sum[3])
{
	for (int c = 0; c < 3; c++) {
		if (w->fresh)
			memset(sum[c], 0, KERNEL_LINE16 * sizeof(*sum[c]));
		for (int k = 0; k < w->count; k++) {
			const int16_t *line = lines +
					      (w->line[k] * w->step + (size_t)c * w->channel) /
						      sizeof(*lines);

			for (int d = 0; d < w->digits; d++) {
				const int32_t weight = *kernel_digit(w, k, c, d);
				const int shift = w->shift + d * KERNEL_DIGIT_BITS;

				for (int p = 0; p < KERNEL_LINE16; p++)
					sum_add(&sum[c][p], line[p] * weight, shift);
			}
		}
	}
}

static void kernel_c_sums8(const int8_t *lines, const struct kernel_weights *w,
			   int64_t *const sum[3])
{
	for (int c = 0; c < 3; c++) {
		if (w->fresh)
			memset(sum[c], 0, KERNEL_LINE8 * sizeof(*sum[c]));
		for (int k = 0; k < w->count; k++) {
			const int8_t *line = lines + w->line[k] * w->step + (size_t)c * w->channel;

			for (int d = 0; d < w->digits; d++) {
				const int32_t weight = *kernel_digit(w, k, c, d);
				const int shift = w->shift + d * KERNEL_DIGIT_BITS;

				for (int p = 0; p < KERNEL_LINE8; p++)
					sum_add(&sum[c][p], line[p] * weight, shift);
			}
		}
	}
}

/* Adds rounded sums to values, modulo 2^32. */
static void kernel_c_add_values(int32_t *value, const int64_t *sum, int count, int shift,
				bool fresh)
{
	for (int p = 0; p < count; p++) {
		const uint32_t before = fresh ? 0 : (uint32_t)value[p];

		value[p] = (int32_t)(before + (uint32_t)round_shift(sum[p], shift));
	}
}

static void kernel_c_values16(const int16_t *lines, const struct kernel_weights *w,
			      int32_t *const value[3])
{
	struct kernel_weights exact = *w;
	int64_t sum[3][KERNEL_LINE16];

	exact.shift = 0;
	exact.fresh = true;
	kernel_c_sums16(lines, &exact, (int64_t *const[3]){sum[0], sum[1], sum[2]});
	for (int c = 0; c < 3; c++)
		kernel_c_add_values(value[c], sum[c], KERNEL_LINE16, KERNEL_VALUE_SHIFT16,
				    w->fresh);
}

static void kernel_c_values8(const int8_t *lines, const struct kernel_weights *w,
			     int32_t *const value[3])
{
	struct kernel_weights exact = *w;
	int64_t sum[3][KERNEL_LINE8];

	exact.shift = 0;
	exact.fresh = true;
	kernel_c_sums8(lines, &exact, (int64_t *const[3]){sum[0], sum[1], sum[2]});
	for (int c = 0; c < 3; c++)
		kernel_c_add_values(value[c], sum[c], KERNEL_LINE8, KERNEL_VALUE_SHIFT8, w->fresh);
}

int kernel_c_split(int64_t (*weight)[KERNEL_WEIGHT], int count, int16_t *digit)
{
	int64_t most = 0;
	int digits;

	for (int k = 0; k < count; k++) {
		for (int c = 0; c < 3; c++) {
			const int64_t w = weight[k][c] < 0 ? -weight[k][c] : weight[k][c];

			most = w > most ? w : most;
		}
	}
	digits = digits_of(most);
	for (int c = 0; c < 3; c++) {
		int16_t *to = digit + 2 * c * digits;

		for (int k = 0; k < count; k += 2, to += 2 * 3 * digits) {
			const uint64_t one = (uint64_t)(weight[k][c] + DIGITS_BIAS);
			const uint64_t next = (uint64_t)(weight[k + 1][c] + DIGITS_BIAS);

			for (int d = 0; d < digits; d++) {
				const int shift = d * KERNEL_DIGIT_BITS;

				to[2 * d] = (int16_t)((one >> shift & 4095) - DIGIT_HALF);
				to[2 * d + 1] = (int16_t)((next >> shift & 4095) - DIGIT_HALF);
			}
		}
	}
	return digits;
}

static int64_t digits_dot(const int16_t *row, const int16_t *digit, int count)
{
	int64_t sum = 0;

	for (int k = 0; k < count; k += KERNEL_LINE16) {
		int32_t part = 0; /* 32 * 32767 * 2048 < 2^31 */

		for (int i = 0; i < KERNEL_LINE16; i++)
			part += row[k + i] * digit[k + i];
		sum += part;
	}
	return sum;
}

static void kernel_c_project(const int16_t *rows, int count, int stride,
			     const struct kernel_vector vector[3], int64_t (*y)[3])
{
	for (int j = 0; j < count; j++, rows += stride) {
		for (int c = 0; c < 3; c++) {
			uint64_t sum = 0;

			for (int d = 0; d < vector[c].digits; d++)
				sum += (uint64_t)digits_dot(rows, vector[c].digit[d], stride)
				       << d * KERNEL_DIGIT_BITS;
			y[j][c] = (int64_t)sum;
		}
	}
}

static int64_t clamp_to_limit(int64_t x)
{
	return x > KERNEL_LIMIT ? KERNEL_LIMIT : x < -KERNEL_LIMIT ? -KERNEL_LIMIT : x;
}

static void kernel_c_fold(const int64_t *sum, int count, int shift, uint32_t factor,
			  const uint16_t *tint, const int32_t *from, int32_t *to)
{
	for (int p = 0; p < count; p++) {
		int64_t x = clamp_to_limit(round_shift(sum[p], shift));

		x = clamp_to_limit(round_shift(x * factor, 30));
		if (tint)
			x = clamp_to_limit(round_shift(x * tint[p], 15));
		to[p] = (int32_t)clamp_to_limit(from[p] + x);
	}
}

void kernel_c_tint(int32_t *value, const uint16_t *by, int count)
{
	for (int n = 0; n < count; n++)
		value[n] = (int32_t)round_shift((int64_t)value[n] * by[n], 15);
}

/* clamp(a + b) for |a|, |b| <= KERNEL_LIMIT, without int64, so that compilers can vectorise it. */
static int32_t added_to_limit(int32_t a, int32_t b)
{
	const int32_t above = KERNEL_LIMIT - (a > 0 ? a : 0);
	const int32_t below = -KERNEL_LIMIT - (a < 0 ? a : 0);

	return a + (b > above ? above : b < below ? below : b);
}

void kernel_c_place(const int32_t *value, const uint16_t row[16], int32_t *to)
{
	for (int y = 0; y < 16; y++, to += 16) {
		/* a run of pixels at a time; adding its lowest bit carries through it */
		for (unsigned bits = row[y]; bits; bits &= bits + (bits & -bits)) {
			const int end = __builtin_ctz(~bits & (bits + (bits & -bits)));

			for (int x = __builtin_ctz(bits); x < end; x++, value++)
				to[x] = added_to_limit(to[x], *value);
		}
	}
}

static uint8_t curve_encode(const struct kernel_curves *k, int32_t key)
{
	const int32_t t = (key & 2047) << 4, piece = key >> 11;
	const int32_t slope = k->b[piece] + ((k->c[piece] * t) >> 16);

	return (uint8_t)((k->a[piece] + ((slope * t) >> 16)) >> 8);
}

/* The key of a pixel's light; 1 - coverage is left / (KERNEL_WHITE / 65535). */
static int32_t kernel_c_key(int32_t object, int32_t taken, float left, uint8_t background,
			    const struct kernel_curves *curves)
{
	float ratio = 1.0f - (float)taken * 0x1p-24f, v;
	int32_t bits, key;

	ratio = ratio > 0.0f ? ratio : 0.0f;
	ratio = ratio < 16.0f ? ratio : 16.0f;
	v = (ratio * left) * curves->linear[background] +
	    ((float)object * (KERNEL_WHITE * 0x1p-24f) + KERNEL_BLACK);
	memcpy(&bits, &v, sizeof(bits));
	key = (bits >> 10) - (135 << 13);
	return key < 0 ? 0 : key > 65535 ? 65535 : key;
}

#define LEFT_ALL (65536 * (KERNEL_WHITE / 65535 / 65536)) /* where coverage is 0 */

/*
 * Each operation of kernel_c_key() is monotone, rounding included, so that the keys of all |taken|
 * <= t lie between those of t and -t, and these move apart as t grows. The curve's pieces need not
 * be monotone: the keys next to that of taken = 0 are tried one by one.
 */
void kernel_c_find_steady(struct kernel_curves *curves)
{
	int32_t steady = KERNEL_FAINT - 1;

	for (int v = 0; v < 256; v++) {
		int32_t least = kernel_c_key(0, 0, LEFT_ALL, (uint8_t)v, curves), most = least;
		int32_t below = -1, above = steady + 1;

		curves->recode[v] = curve_encode(curves, least);
		while (least > 0 && curve_encode(curves, least - 1) == curves->recode[v])
			least--;
		while (most < 65535 && curve_encode(curves, most + 1) == curves->recode[v])
			most++;
		while (above - below > 1) {
			const int32_t t = (below + above) / 2;

			if (kernel_c_key(0, t, LEFT_ALL, (uint8_t)v, curves) >= least &&
			    kernel_c_key(0, -t, LEFT_ALL, (uint8_t)v, curves) <= most)
				below = t;
			else
				above = t;
		}
		curves->steady[v] = steady = below;
	}
}

static uint8_t kernel_c_mix_one(int32_t object, int32_t taken, float left, uint8_t background,
				const struct kernel_curves *curves)
{
	return curve_encode(curves, kernel_c_key(object, taken, left, background, curves));
}

static void kernel_c_mix_row(const struct kernel_row *row)
{
	for (int x = 0; x < row->count; x++) {
		const uint8_t *in = row->background + (size_t)x * 4;
		uint8_t *out = row->out + (size_t)x * 4;
		const int32_t covered = row->coverage ? row->coverage[x] : 0;
		/* 1 - coverage, rounded: a / 65535 is (a + a / 32768) / 65536. */
		const int32_t rest = 65536 - covered - (covered >> 15);
		const float left = (float)rest * (KERNEL_WHITE / 65535 / 65536);

		for (int c = 0; c < 3; c++) /* R, G, B lie at bytes 2, 1, 0 */
			out[2 - c] = kernel_c_mix_one(row->coverage ? row->object[c][x] : 0,
						      row->taken[c][x], left, in[2 - c],
						      row->curves);
		out[3] = 255;
	}
}

static void kernel_c_mix(const struct kernel_row *rows)
{
	struct kernel_row row = *rows;

	for (int y = 0; y < rows->rows; y++, kernel_row_next(&row))
		kernel_c_mix_row(&row);
}

const struct kernels kernels_c = {
	.name = "c",
	.supported = kernel_c_supported,
	.sums16 = kernel_c_sums16,
	.sums8 = kernel_c_sums8,
	.values16 = kernel_c_values16,
	.values8 = kernel_c_values8,
	.split = kernel_c_split,
	.project = kernel_c_project,
	.fold = kernel_c_fold,
	.tint = kernel_c_tint,
	.place = kernel_c_place,
	.mix = kernel_c_mix,
	.grain = kernel_add_grain,
	.divide = kernel_divide,
};
