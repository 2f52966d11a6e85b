/* SPDX-License-Identifier: MIT */
/* Comparisons of the kernels for pixels: fold and tint sums, place them, mix them with the
 * background. */
#include "tests/kernels/compare_parts.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- fold ---- */

/* A sum, often near a value at which rounding or clamping changes. */
static int64_t fold_sum(struct comparison *c, int shift)
{
	const int64_t limit = INT64_C(1) << 62;
	const int64_t unit = INT64_C(1) << (shift - 1); /* half of the rounding step */
	int64_t x = compare_spread(c, 62);

	switch (compare_below(c, 6)) {
	case 0: /* ties and their neighbours */
		x = x / unit * unit + compare_between(c, -1, 1);
		break;
	case 1: /* near the clamping limit, and near the end of int32 */
		if (shift < 31)
			x = (compare_below(c, 2) ? KERNEL_LIMIT : INT64_C(0x7fffffff)) * unit * 2 +
			    compare_between(c, -2, 2) * unit;
		x = compare_below(c, 2) ? x : -x;
		break;
	case 2:
		x = compare_below(c, 2) ? limit : -limit;
		break;
	default:
		break;
	}
	return x > limit ? limit : x < -limit ? -limit : x;
}

static uint32_t fold_factor(struct comparison *c)
{
	static const uint32_t ends[] = {0, 1, 1U << 30, (1U << 30) - 1, (1U << 31) - 1, 1U << 31};
	const int which = compare_below(c, 12);

	return which < 6 ? ends[which] : (uint32_t)(compare_next(c) >> 33 >> compare_below(c, 31));
}

static int32_t fold_to(struct comparison *c)
{
	switch (compare_below(c, 4)) {
	case 0:
		return compare_below(c, 2) ? KERNEL_LIMIT : -KERNEL_LIMIT;
	case 1:
		return compare_below(c, 2) ? INT32_MAX : INT32_MIN;
	default:
		return (int32_t)compare_spread(c, 31);
	}
}

bool compare_fold(struct comparison *c, const struct kernels *tables[2], char *why)
{
	const int count = c->round < 256 ? c->round + 1 : compare_between(c, 1, 256);
	const int shift = compare_between(c, 1, 62);
	const uint32_t factor = fold_factor(c);
	const size_t size = (size_t)count * sizeof(int32_t);
	int64_t *sum = guarded_take(&c->lines, (size_t)count * sizeof(*sum));
	uint16_t *tint = guarded_take(&c->coverage, (size_t)count * sizeof(*tint));
	const bool tinted = compare_below(c, 2), dark = compare_below(c, 2);
	const bool apart = compare_below(c, 2);
	int32_t *other = guarded_take(&c->object[0], size), *to[2];

	for (int i = 0; i < 2; i++)
		to[i] = guarded_take(&c->out[i], size);
	for (int p = 0; p < count; p++) {
		sum[p] = fold_sum(c, shift);
		tint[p] = (uint16_t)(compare_next(c) % (dark ? 32769 : 65536));
		if (compare_below(c, 4) == 0)
			tint[p] = dark || compare_below(c, 2) ? 32768 : 65535;
		to[0][p] = to[1][p] = fold_to(c);
		other[p] = fold_to(c);
	}
	for (int i = 0; i < 2; i++)
		tables[i]->fold(sum, count, shift, factor, tinted ? tint : NULL,
				apart ? other : to[i], to[i]);
	for (int p = 0; p < count; p++) {
		if (to[0][p] != to[1][p]) {
			snprintf(why, 256,
				 "%d of %d: sum %" PRId64 " >> %d * %u, tint %d: %d, expected %d",
				 p, count, sum[p], shift, factor, tinted ? tint[p] : -1, to[1][p],
				 to[0][p]);
			return false;
		}
	}
	return guarded_intact(&c->out[1], size);
}

/* ---- tint ---- */

bool compare_tint(struct comparison *c, const struct kernels *tables[2], char *why)
{
	const int count = c->round < 256 ? c->round + 1 : compare_between(c, 1, 256);
	const size_t size = (size_t)count * sizeof(int32_t);
	uint16_t *tint = guarded_take(&c->coverage, (size_t)count * sizeof(*tint));
	int32_t *from = guarded_take(&c->object[0], size), *value[2];

	for (int i = 0; i < 2; i++)
		value[i] = guarded_take(&c->out[i], size);
	for (int n = 0; n < count; n++) {
		tint[n] = (uint16_t)(compare_below(c, 4)   ? compare_next(c) % 65536
				     : compare_below(c, 2) ? 32768
							   : 65535);
		from[n] = (int32_t)compare_spread(c, 30);
		value[0][n] = value[1][n] = from[n];
	}
	for (int i = 0; i < 2; i++)
		tables[i]->tint(value[i], tint, count);
	for (int n = 0; n < count; n++) {
		if (value[0][n] != value[1][n]) {
			snprintf(why, 256, "%d of %d: %d, tint %d: %d, expected %d", n, count,
				 from[n], tint[n], value[1][n], value[0][n]);
			return false;
		}
	}
	return guarded_intact(&c->out[1], size);
}

/* ---- place ---- */

static int32_t placed(struct comparison *c)
{
	const int64_t x = compare_below(c, 4) ? compare_spread(c, 32) : 0;

	return (int32_t)(x > KERNEL_LIMIT ? KERNEL_LIMIT : x < -KERNEL_LIMIT ? -KERNEL_LIMIT : x);
}

bool compare_place(struct comparison *c, const struct kernels *tables[2], char *why)
{
	const size_t size = 256 * sizeof(int32_t);
	uint16_t row[16];
	int32_t *to[2], *value;
	int bits = 0;

	for (int y = 0; y < 16; y++) {
		row[y] = compare_below(c, 4)   ? (uint16_t)compare_next(c)
			 : compare_below(c, 2) ? UINT16_MAX
					       : 0;
		bits += __builtin_popcount(row[y]);
	}
	value = guarded_take(&c->lines, (size_t)(bits + KERNEL_PLACE_BEYOND) * sizeof(*value));
	for (int i = 0; i < bits + KERNEL_PLACE_BEYOND; i++)
		value[i] = placed(c);
	for (int i = 0; i < 2; i++)
		to[i] = guarded_take(&c->out[i], size);
	for (int p = 0; p < 256; p++)
		to[0][p] = to[1][p] = placed(c);
	for (int i = 0; i < 2; i++)
		tables[i]->place(value, row, to[i]);
	for (int p = 0; p < 256; p++) {
		if (to[0][p] != to[1][p]) {
			snprintf(why, 256, "row %d, pixel %d: %d, expected %d", p / 16, p % 16,
				 to[1][p], to[0][p]);
			return false;
		}
	}
	return guarded_intact(&c->out[1], size);
}

/* ---- mix ---- */

static int32_t mix_taken(struct comparison *c)
{
	static const int32_t ends[] = {0,	  1 << 24,   (1 << 24) + 1, -15 * (1 << 24),
				       INT32_MIN, INT32_MAX, (1 << 24) - 1, -15 * (1 << 24) - 1};

	return compare_below(c, 3) ? (int32_t)compare_spread(c, 26) : ends[compare_below(c, 8)];
}

static uint16_t mix_coverage(struct comparison *c)
{
	static const uint16_t ends[] = {0, 65535, 32767, 32768};

	return compare_below(c, 2) ? (uint16_t)compare_next(c) : ends[compare_below(c, 4)];
}

/* Number of values from the first of a row to the last of the last row; rows are `step` apart. */
static size_t span(const struct kernel_row *row, ptrdiff_t step)
{
	return (size_t)(row->rows - 1) * (size_t)step + (size_t)row->count;
}

static struct kernel_row make_row(struct comparison *c, int count)
{
	struct kernel_row row = {
		.count = count,
		.rows = compare_between(c, 1, ROWS_MIXED),
		.value_step = count + compare_below(c, GAP_MAX),
		.coverage_step = count + compare_below(c, GAP_MAX),
		.background_step = 4 * (count + compare_below(c, GAP_MAX)),
		.out_step = 4 * (count + compare_below(c, GAP_MAX)),
		.curves = &c->curves[compare_below(c, TRANSFER_COUNT)]
				    [compare_below(c, TRANSFER_COUNT)],
	};
	const size_t values = span(&row, row.value_step), alphas = span(&row, row.coverage_step);
	const size_t bytes = 4 * span(&row, row.background_step / 4);
	uint16_t *coverage = guarded_take(&c->coverage, alphas * sizeof(*coverage));
	uint8_t *background = guarded_take(&c->background, bytes);

	for (int k = 0; k < 3; k++) {
		int32_t *object = guarded_take(&c->object[k], values * sizeof(*object));
		int32_t *taken = guarded_take(&c->taken[k], values * sizeof(*taken));

		for (size_t x = 0; x < values; x++) {
			object[x] = compare_below(c, 2) ? (int32_t)compare_spread(c, 25)
				    : compare_below(c, 8)
					    ? 0
					    : (compare_below(c, 2) ? INT32_MAX : INT32_MIN);
			taken[x] = mix_taken(c);
		}
		row.object[k] = object;
		row.taken[k] = taken;
	}
	for (size_t x = 0; x < alphas; x++)
		coverage[x] = mix_coverage(c);
	for (size_t i = 0; i < bytes; i++)
		background[i] = (uint8_t)compare_next(c);
	row.coverage = compare_below(c, 4) ? coverage : NULL;
	row.background = background;
	return row;
}

bool compare_mix(struct comparison *c, const struct kernels *tables[2], char *why)
{
	const int count = c->round < 132 ? c->round / 2 : compare_between(c, 1, WIDTH);
	const int beyond = compare_below(
		c, 20); /* pixels after the row, which must stay unchanged; else the guard page */
	struct kernel_row row = make_row(c, count);
	const size_t size = 4 * (span(&row, row.out_step / 4) + (size_t)beyond);
	uint8_t *out[2];

	for (int i = 0; i < 2; i++) {
		out[i] = guarded_take(&c->out[i], size);
		memset(out[i], 0x3c, size);
		row.out = out[i];
		tables[i]->mix(&row);
	}
	for (size_t i = 0; i < size; i++) {
		if (out[0][i] != out[1][i]) {
			snprintf(why, 256, "byte %zu of %d rows of %d pixels: %d, expected %d", i,
				 row.rows, count, out[1][i], out[0][i]);
			return false;
		}
	}
	return guarded_intact(&c->out[1], size);
}

/* ---- grain ---- */

bool compare_grain(struct comparison *c, const struct kernels *tables[2], char *why)
{
	enum { ROWS_GRAIN = 3, STEP = KERNEL_GRAIN + 5, PIXELS = ROWS_GRAIN * KERNEL_GRAIN };
	static const float strengths[] = {0, 1e-6f, 1e-4f, 0.01f};
	static int32_t object[3][PIXELS], taken[3][PIXELS];
	static int8_t noise[3][ROWS_GRAIN * STEP];
	const size_t size = sizeof(object), pixels = (size_t)(ROWS_GRAIN - 1) * STEP + KERNEL_GRAIN;
	uint16_t *coverage = guarded_take(&c->coverage, pixels * sizeof(*coverage));
	uint8_t *background = guarded_take(&c->background, pixels * 4);
	struct kernel_grain tile = {.rows = ROWS_GRAIN,
				    .coverage = coverage,
				    .background = background,
				    .curves = &c->curves[compare_below(c, TRANSFER_COUNT)][0],
				    .coverage_step = STEP,
				    .noise_step = STEP,
				    .background_step = (ptrdiff_t)STEP * 4};
	int32_t *out[2];

	for (size_t i = 0; i < pixels; i++)
		coverage[i] = mix_coverage(c);
	for (size_t i = 0; i < 4 * pixels; i++)
		background[i] = (uint8_t)compare_below(c, 256);
	for (int k = 0; k < 3; k++) {
		for (int i = 0; i < PIXELS; i++) {
			object[k][i] = compare_below(c, 3) ? (int32_t)compare_spread(c, 26) : 0;
			taken[k][i] = mix_taken(c);
		}
		for (int i = 0; i < ROWS_GRAIN * STEP; i++)
			noise[k][i] = (int8_t)compare_between(c, -127, 127);
		tile.object[k] = object[k];
		tile.taken[k] = taken[k];
		tile.noise[k] = noise[k];
		tile.floor[k] = strengths[compare_below(c, 4)];
		tile.slope[k] = strengths[compare_below(c, 4)];
	}
	for (int i = 0; i < 2; i++) {
		struct kernel_grain one = tile;

		out[i] = guarded_take(&c->out[i], size);
		for (int k = 0; k < 3; k++)
			one.to[k] = out[i] + (size_t)k * PIXELS;
		tables[i]->grain(&one);
	}
	for (int i = 0; i < 3 * PIXELS; i++)
		if (out[0][i] != out[1][i]) {
			snprintf(why, 256, "value %d: %d, expected %d", i, out[1][i], out[0][i]);
			return false;
		}
	return guarded_intact(&c->out[1], size);
}

/* ---- divide ---- */

bool compare_divide(struct comparison *c, const struct kernels *tables[2], char *why)
{
	static int32_t value[256];
	float grid[KERNEL_GRID * KERNEL_GRID];
	int32_t *out[2];

	for (int p = 0; p < 256; p++)
		value[p] = compare_below(c, 9) ? (int32_t)compare_spread(c, 30) : KERNEL_LIMIT;
	for (int k = 0; k < KERNEL_GRID * KERNEL_GRID; k++)
		grid[k] = ldexpf((float)compare_between(c, 1, 1000), compare_between(c, -20, 10));
	for (int i = 0; i < 2; i++) {
		out[i] = guarded_take(&c->out[i], sizeof(value));
		memcpy(out[i], value, sizeof(value));
		tables[i]->divide(out[i], grid);
	}
	for (int p = 0; p < 256; p++)
		if (out[0][p] != out[1][p]) {
			snprintf(why, 256, "value %d: %d, expected %d", p, out[1][p], out[0][p]);
			return false;
		}
	return guarded_intact(&c->out[1], sizeof(value));
}
