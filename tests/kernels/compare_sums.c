/* SPDX-License-Identifier: MIT */
/* Comparisons of the kernels for lines: sums of lines, splits of weights into digits, projections.
 */
#include "tests/kernels/compare_parts.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#define LINES 40 /* few, so that weights name each of them several times */
#define STEP_MAX 12
#define FULL_ROUND 40 /* the round in which sums are as large as they can become */

/* ---- sums16, sums8 ---- */

static int weights_count(struct comparison *c)
{
	if (c->round == 0)
		return WEIGHTS_LONG;
	if (c->round < FULL_ROUND) /* every small number: the ends of runs */
		return 2 * c->round - 2;
	if (c->round == FULL_ROUND)
		return 96;
	return 2 * compare_below(c, (c->round % 8 ? 100 : WEIGHTS) / 2 + 1);
}

/*
 * Digit of line k, for lines of value -32767. The sum of the first 32 products is one less than a
 * multiple of 65536; the later sums are as large as a sum of 32 products can be. A kernel that
 * carries all but the lowest 16 bits of the first sum elsewhere, and adds the next sum to those 16
 * bits, comes to 2^31 - 1.
 */
static int16_t full_digit(int k)
{
	return (int16_t)(k < 16 || k >= 32 ? -2048 : k == 16 ? -1 : 0);
}

/* Weights of lines of one, two or three channels, one after the other, with gaps or without.
 * `full`: the digits make the largest possible sums. */
static struct kernel_weights make_weights(struct comparison *c, int count, bool full)
{
	const bool ordered = compare_below(c, 2);
	struct kernel_weights w = {
		.count = count,
		.digits = compare_between(c, 1, KERNEL_DIGITS),
		.shift = compare_below(c, KERNEL_SHIFT_MAX + 1),
		.fresh = compare_below(c, 2),
		.step = (size_t)compare_between(c, 1, STEP_MAX) * KERNEL_LINE_BYTES,
		.channel = compare_below(c, 2)
				   ? (size_t)compare_between(c, 1, LINES) * KERNEL_LINE_BYTES
				   : 0,
	};
	uint32_t *line = guarded_take(&c->line, (size_t)w.count * sizeof(*line));
	const int values = w.count * 3 * w.digits;
	int16_t *digit = guarded_take(&c->weight, (size_t)values * sizeof(*digit));

	for (int k = 0; k < w.count; k++)
		line[k] = (uint32_t)(ordered ? k % LINES : compare_below(c, LINES));
	compare_fill16(c, digit, values, -2048, 2047);
	for (int i = 0; i < values && c->round == 0; i++) /* the values that overflow first */
		digit[i] = i / 2 % 2 ? 2047 : -2048;
	for (int i = 0; i < values && c->round == FULL_ROUND; i++)
		digit[i] = full_digit(i / (2 * 3 * w.digits) * 2 + i % 2);
	for (int i = 0; i < values && full; i++)
		digit[i] = -2048;
	w.line = line;
	w.digit = digit;
	return w;
}

/* Makes the lines that the weights name. */
static void *make_lines(struct comparison *c, const struct kernel_weights *w, bool bytes,
			enum filling filling)
{
	const size_t last = (LINES - 1) * w->step + 2 * w->channel + KERNEL_LINE_BYTES;
	const int values = (int)(bytes ? last : last / sizeof(int16_t));
	void *lines = guarded_take(&c->lines, last);

	for (int i = 0; i < values; i++) {
		if (bytes)
			((int8_t *)lines)[i] = (int8_t)compare_value(c, filling, i, -127, 127);
		else
			((int16_t *)lines)[i] = (int16_t)compare_value(c, filling, i, -32767,
								       32767);
	}
	return lines;
}

/* Whether both tables made the same sums from the same start. */
static bool same_sums(struct comparison *c, const struct kernel_weights *w, int64_t *sum[2][3],
		      int count, char *why)
{
	for (int i = 0; i < 3 * count; i++) {
		const int64_t truth = sum[0][i / count][i % count];
		const int64_t other = sum[1][i / count][i % count];

		if (truth != other) {
			snprintf(why, 256,
				 "%d weights of %d digits, channel %d, pixel %d: %" PRId64
				 ", expected %" PRId64,
				 w->count, w->digits, i / count, i % count, other, truth);
			return false;
		}
	}
	for (int k = 0; k < 3; k++) {
		if (!guarded_intact(&c->sum[1][k], (size_t)count * sizeof(int64_t)))
			return false;
	}
	return true;
}

bool compare_sums(struct comparison *c, bool bytes, const struct kernels *tables[2], char *why)
{
	const int pixels = bytes ? KERNEL_LINE8 : KERNEL_LINE16;
	const int beyond = compare_below(
		c, 8); /* values after the sums, so that the alignment of the sums varies */
	const struct kernel_weights w = make_weights(c, weights_count(c), false);
	const enum filling filling = c->round == 0 ? HIGHEST
				     : c->round == FULL_ROUND
					     ? LOWEST
					     : (enum filling)compare_below(c, FILLINGS);
	const void *lines = make_lines(c, &w, bytes, filling);
	int64_t *sum[2][3];

	for (int k = 0; k < 3; k++) {
		for (int i = 0; i < 2; i++)
			sum[i][k] = guarded_take(&c->sum[i][k],
						 (size_t)(pixels + beyond) * sizeof(int64_t));
		for (int p = 0; p < pixels + beyond; p++)
			sum[0][k][p] = sum[1][k][p] = compare_spread(c, 61);
	}
	for (int i = 0; i < 2; i++) {
		if (bytes)
			tables[i]->sums8(lines, &w, sum[i]);
		else
			tables[i]->sums16(lines, &w, sum[i]);
	}
	return same_sums(c, &w, sum, pixels + beyond, why);
}

/* ---- values16, values8 ---- */

/* Rounds in which the values of a run are the highest and the lowest possible. */
#define VALUES_HIGHEST 20
#define VALUES_LOWEST 21

bool compare_values(struct comparison *c, bool bytes, const struct kernels *tables[2], char *why)
{
	const int pixels = bytes ? KERNEL_LINE8 : KERNEL_LINE16, beyond = compare_below(c, 8);
	const size_t size = (size_t)(pixels + beyond) * sizeof(int32_t);
	const bool full = c->round == VALUES_HIGHEST || c->round == VALUES_LOWEST;
	const int most = bytes ? KERNEL_VALUE_LINES8 : KERNEL_RUN;
	const int count = full			 ? most
			  : c->round <= most / 2 ? 2 * c->round
						 : 2 * compare_below(c, most / 2 + 1);
	const struct kernel_weights w = make_weights(c, count, full);
	const enum filling filling = c->round == VALUES_HIGHEST ? LOWEST
				     : c->round == VALUES_LOWEST
					     ? HIGHEST
					     : (enum filling)compare_below(c, FILLINGS);
	const void *lines = make_lines(c, &w, bytes, filling);
	int32_t *value[2][3];

	for (int k = 0; k < 3; k++) {
		for (int i = 0; i < 2; i++)
			value[i][k] = guarded_take(&c->sum[i][k], size);
		for (int p = 0; p < pixels + beyond; p++)
			value[0][k][p] = value[1][k][p] = (int32_t)compare_next(c);
	}
	for (int i = 0; i < 2; i++) {
		if (bytes)
			tables[i]->values8(lines, &w, value[i]);
		else
			tables[i]->values16(lines, &w, value[i]);
	}
	for (int i = 0; i < 3 * (pixels + beyond); i++) {
		const int k = i / (pixels + beyond), p = i % (pixels + beyond);

		if (value[0][k][p] != value[1][k][p]) {
			snprintf(why, 256,
				 "%d weights of %d digits, channel %d, pixel %d: %d, expected %d",
				 w.count, w.digits, k, p, value[1][k][p], value[0][k][p]);
			return false;
		}
	}
	return guarded_intact(&c->sum[1][0], size) && guarded_intact(&c->sum[1][1], size) &&
	       guarded_intact(&c->sum[1][2], size);
}

/* ---- split ---- */

bool compare_split(struct comparison *c, const struct kernels *tables[2], char *why)
{
	const int count = weights_count(c) % WEIGHTS, bits = compare_below(c, 47);
	const size_t size = (size_t)count * 3 * KERNEL_DIGITS * sizeof(int16_t);
	int64_t(*weight)[KERNEL_WEIGHT] = guarded_take(&c->object[0],
						       (size_t)count * sizeof(*weight));
	int16_t *digit[2];
	int digits[2];

	for (int i = 0; i < count; i++) {
		for (int k = 0; k < 3; k++)
			weight[i][k] = compare_below(c, 8)
					       ? compare_spread(c, bits)
					       : (INT64_C(1) << bits) - compare_below(c, 2);
		/* the fourth weight, which no kernel may read */
		weight[i][3] = compare_below(c, 2) ? INT64_MIN : INT64_MAX;
	}
	for (int i = 0; i < 2; i++) {
		digit[i] = guarded_take(i ? &c->weight : &c->lines, size);
		memset(digit[i], 0x5a, size);
		digits[i] = tables[i]->split(weight, count, digit[i]);
	}
	for (int i = 0; i < count * 3 * KERNEL_DIGITS; i++) {
		if (digits[0] != digits[1] || digit[0][i] != digit[1][i]) {
			snprintf(why, 256,
				 "%d digits, expected %d; of %d weights, %d: %d, expected %d",
				 digits[1], digits[0], count, i, digit[1][i], digit[0][i]);
			return false;
		}
	}
	return guarded_intact(&c->weight, size);
}

/* ---- project ---- */

bool compare_project(struct comparison *c, const struct kernels *tables[2], char *why)
{
	const int stride = 32 *
			   (c->round < 40 ? c->round + 1 : compare_between(c, 1, STRIDE_MAX / 32));
	const int count = compare_below(c, ROWS + 1);
	const size_t size = (size_t)count * 3 * sizeof(int64_t);
	const bool same = compare_below(c, 2);
	const int digits = compare_below(c, KERNEL_DIGITS + 1);
	struct kernel_vector vector[3];
	int16_t *rows = guarded_take(&c->lines, (size_t)(count * stride) * sizeof(*rows));
	int64_t(*y[2])[3];

	compare_fill16(c, rows, count * stride, -32767, 32767);
	for (int k = 0; k < 3; k++) {
		vector[k].digits = same ? digits : compare_below(c, KERNEL_DIGITS + 1);
		for (int d = 0; d < KERNEL_DIGITS; d++) {
			void *plane = guarded_take(&c->digit[k][d], (size_t)stride * 2);

			/* Values beyond the digits must not count. */
			compare_fill16(c, plane, stride, -2048, 2047);
			vector[k].digit[d] = d < vector[k].digits ? plane : NULL;
		}
	}
	for (int i = 0; i < 2; i++) {
		y[i] = guarded_take(&c->out[i], size);
		memset(y[i], 0x5a, size);
		tables[i]->project(rows, count, stride, vector, y[i]);
	}
	for (int j = 0; j < count * 3; j++) {
		if (y[0][j / 3][j % 3] != y[1][j / 3][j % 3]) {
			snprintf(why, 256,
				 "row %d of %d values, channel %d: %" PRId64 ", expected %" PRId64,
				 j / 3, stride, j % 3, y[1][j / 3][j % 3], y[0][j / 3][j % 3]);
			return false;
		}
	}
	return guarded_intact(&c->out[1], size);
}
