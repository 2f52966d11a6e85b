/* SPDX-License-Identifier: MIT */
#include "tests/kernels/faults.h"

#include <stdlib.h>
#include <string.h>

/* ---- sums ---- */

typedef int64_t *const sums_of[3];

static void digit_dropped16(const int16_t *lines, const struct kernel_weights *w, sums_of sum)
{
	static int16_t digit[3 * KERNEL_DIGITS * 128];
	struct kernel_weights less = *w;

	for (int i = 0; i < w->count * 3 * w->digits && w->count <= 128; i++)
		digit[i] = i / 2 % w->digits == 3 ? 0 : w->digit[i];
	less.digit = w->count <= 128 ? digit : w->digit;
	kernels_c.sums16(lines, &less, sum);
}

static void pair_dropped16(const int16_t *lines, const struct kernel_weights *w, sums_of sum)
{
	struct kernel_weights less = *w;

	less.count = w->count / 4 * 4;
	kernels_c.sums16(lines, &less, sum);
}

static void lines_in_order16(const int16_t *lines, const struct kernel_weights *w, sums_of sum)
{
	struct kernel_weights other = *w;
	static uint32_t line[1024];

	for (uint32_t i = 0; i < 1024; i++)
		line[i] = i % 40;
	if (w->count <= 1024)
		other.line = line;
	kernels_c.sums16(lines, &other, sum);
}

static void not_added16(const int16_t *lines, const struct kernel_weights *w, sums_of sum)
{
	struct kernel_weights fresh = *w;

	fresh.fresh = true;
	kernels_c.sums16(lines, &fresh, sum);
}

static void always_added8(const int8_t *lines, const struct kernel_weights *w, sums_of sum)
{
	struct kernel_weights added = *w;

	added.fresh = false;
	kernels_c.sums8(lines, &added, sum);
}

static void channel_shared16(const int16_t *lines, const struct kernel_weights *w, sums_of sum)
{
	struct kernel_weights shared = *w;

	shared.channel = 0;
	kernels_c.sums16(lines, &shared, sum);
}

static void not_shifted8(const int8_t *lines, const struct kernel_weights *w, sums_of sum)
{
	struct kernel_weights low = *w;

	low.shift = w->shift & 7;
	kernels_c.sums8(lines, &low, sum);
}

static void stepped_close8(const int8_t *lines, const struct kernel_weights *w, sums_of sum)
{
	struct kernel_weights close = *w;

	close.step = KERNEL_LINE_BYTES;
	kernels_c.sums8(lines, &close, sum);
}

static void faults_add(int64_t *sum, int64_t more, int shift)
{
	*sum = (int64_t)((uint64_t)*sum + ((uint64_t)more << shift));
}

/* Adds up lines in int32 for longer than the products fit. */
static void widened_late16(const int16_t *lines, const struct kernel_weights *w, sums_of sum)
{
	struct kernel_weights none = *w;

	none.count = 0;
	kernels_c.sums16(lines, &none, sum);
	for (int i = 0; i < 3 * w->digits * KERNEL_LINE16; i++) {
		const int p = i % KERNEL_LINE16, d = i / KERNEL_LINE16 % w->digits;
		const int c = i / KERNEL_LINE16 / w->digits;
		const int16_t *from = lines + (size_t)c * w->channel / 2 + p;

		for (int run = 0; run < w->count; run += 34) {
			uint32_t part = 0;

			for (int k = run; k < w->count && k < run + 34; k++)
				part += (uint32_t)(from[w->line[k] * w->step / 2] *
						   *kernel_digit(w, k, c, d));
			faults_add(&sum[c][p], (int32_t)part, d * KERNEL_DIGIT_BITS + w->shift);
		}
	}
}

/* Takes the low byte of each digit with the instruction that adds two products of bytes in 16 bits
 * and saturates. */
static void saturated8(const int8_t *lines, const struct kernel_weights *w, sums_of sum)
{
	struct kernel_weights none = *w;

	none.count = 0;
	kernels_c.sums8(lines, &none, sum);
	for (int i = 0; i < 3 * w->digits * KERNEL_LINE8; i++) {
		const int p = i % KERNEL_LINE8, d = i / KERNEL_LINE8 % w->digits;
		const int c = i / KERNEL_LINE8 / w->digits;
		const int8_t *from = lines + (size_t)c * w->channel + p;

		for (int k = 0; k < w->count; k += 2) {
			int64_t pair = 0, rest = 0;

			for (int n = k; n < k + 2; n++) {
				const int digit = *kernel_digit(w, n, c, d), low = (int8_t)digit;
				const int x = from[w->line[n] * w->step];

				pair += (x + 128) * low;
				rest += x * (digit - low) - 128 * low;
			}
			pair = pair > 32767 ? 32767 : pair < -32768 ? -32768 : pair;
			faults_add(&sum[c][p], pair + rest, d * KERNEL_DIGIT_BITS + w->shift);
		}
	}
}

static void last_pixel8(const int8_t *lines, const struct kernel_weights *w, sums_of sum)
{
	const int64_t last = sum[2][KERNEL_LINE8 - 1];

	kernels_c.sums8(lines, w, sum);
	if (w->count > 1000)
		sum[2][KERNEL_LINE8 - 1] = last;
}

static void wrote_beyond8(const int8_t *lines, const struct kernel_weights *w, sums_of sum)
{
	kernels_c.sums8(lines, w, sum);
	sum[1][-1]++;
}

/* ---- split ---- */

static int digit_of_half(int64_t (*weight)[KERNEL_WEIGHT], int count, int16_t *digit)
{
	const int digits = kernels_c.split(weight, count, digit);

	for (int i = 0; i < count * 3 * digits; i++) { /* 2048, where -2048 with a carry is right */
		if (digit[i] == -2048)
			digit[i] = 2048;
	}
	return digits;
}

static int channel_left(int64_t (*weight)[KERNEL_WEIGHT], int count, int16_t *digit)
{
	int64_t(*two)[KERNEL_WEIGHT] = malloc(sizeof(*two) * (size_t)(count + 1));
	int digits;

	for (int k = 0; k < count; k++) {
		memcpy(two[k], weight[k], sizeof(*two));
		two[k][2] = two[k][1];
	}
	digits = kernels_c.split(two, count, digit);
	free(two);
	return digits;
}

/* ---- project ---- */

static void run_dropped(const int16_t *rows, int count, int stride,
			const struct kernel_vector vector[3], int64_t (*y)[3])
{
	/* Takes the last 32 of every row for padding where the rest is a multiple of 512. */
	for (int j = 0; j < count; j++)
		kernels_c.project(rows + (size_t)j * (size_t)stride, 1,
				  stride % 512 == 32 && stride > 512 ? stride - 32 : stride, vector,
				  y + j);
}

static void digits_of_first(const int16_t *rows, int count, int stride,
			    const struct kernel_vector vector[3], int64_t (*y)[3])
{
	struct kernel_vector same[3] = {vector[0], vector[1], vector[2]};

	if (vector[0].digits < vector[2].digits)
		same[2].digits = vector[0].digits;
	kernels_c.project(rows, count, stride, same, y);
}

static void narrow(const int16_t *rows, int count, int stride, const struct kernel_vector vector[3],
		   int64_t (*y)[3])
{
	kernels_c.project(rows, count, stride, vector, y);
	for (int j = 0; j < count; j++) {
		for (int c = 0; c < 3; c++)
			y[j][c] = vector[c].digits == 1 ? (int32_t)y[j][c] : y[j][c];
	}
}

/* ---- fold ---- */

static void rounded_down(const int64_t *sum, int count, int shift, uint32_t factor,
			 const uint16_t *tint, const int32_t *from, int32_t *to)
{
	for (int p = 0; p < count; p++) {
		const int64_t down = sum[p] & -(INT64_C(1) << shift);

		kernels_c.fold(&down, 1, shift, factor, tint ? tint + p : NULL, from + p, to + p);
	}
}

static void tail_left(const int64_t *sum, int count, int shift, uint32_t factor,
		      const uint16_t *tint, const int32_t *from, int32_t *to)
{
	kernels_c.fold(sum, count > 8 ? count & ~1 : count, shift, factor, tint, from, to);
}

static void factor_signed(const int64_t *sum, int count, int shift, uint32_t factor,
			  const uint16_t *tint, const int32_t *from, int32_t *to)
{
	kernels_c.fold(sum, count, shift, factor >> 31 ? 0 : factor, tint, from, to);
}

static void not_clamped(const int64_t *sum, int count, int shift, uint32_t factor,
			const uint16_t *tint, const int32_t *from, int32_t *to)
{
	for (int p = 0; p < count; p++) {
		int32_t x = 0;

		kernels_c.fold(sum + p, 1, shift, factor, tint ? tint + p : NULL, &x, &x);
		to[p] = (int32_t)((uint32_t)from[p] + (uint32_t)x);
	}
}

/* ---- values, tint ---- */

typedef int32_t *const values_of[3];

static void digit_dropped_values16(const int16_t *lines, const struct kernel_weights *w,
				   values_of value)
{
	struct kernel_weights less = *w;
	int16_t digit[3 * KERNEL_DIGITS * KERNEL_RUN];

	for (int i = 0; i < w->count * 3 * w->digits; i++)
		digit[i] = i / 2 % w->digits == 3 ? 0 : w->digit[i];
	less.digit = digit;
	kernels_c.values16(lines, &less, value);
}

/* Truncates where it should round. */
static void cut16(const int16_t *lines, const struct kernel_weights *w, values_of value)
{
	int64_t sum[3][KERNEL_LINE16];
	struct kernel_weights exact = *w;

	exact.shift = 0;
	exact.fresh = true;
	kernels_c.sums16(lines, &exact, (int64_t *const[3]){sum[0], sum[1], sum[2]});
	for (int i = 0; i < 3 * KERNEL_LINE16; i++) {
		const int c = i / KERNEL_LINE16, p = i % KERNEL_LINE16;
		const uint32_t more = (uint32_t)(sum[c][p] >> KERNEL_VALUE_SHIFT16);

		value[c][p] = (int32_t)((w->fresh ? 0 : (uint32_t)value[c][p]) + more);
	}
}

static void always_fresh8(const int8_t *lines, const struct kernel_weights *w, values_of value)
{
	struct kernel_weights fresh = *w;

	fresh.fresh = true;
	kernels_c.values8(lines, &fresh, value);
}

/* Adds the highest digit once more, unshifted. */
static void shift_wrapped8(const int8_t *lines, const struct kernel_weights *w, values_of value)
{
	kernels_c.values8(lines, w, value);
	for (int c = 0; c < 3 && w->digits == KERNEL_DIGITS; c++)
		for (int p = 0; p < KERNEL_LINE8; p++) {
			uint32_t top = 0;

			for (int k = 0; k < w->count; k++)
				top += (uint32_t)(lines[w->line[k] * w->step +
							(size_t)c * w->channel + (size_t)p] *
						  *kernel_digit(w, k, c, KERNEL_DIGITS - 1));
			value[c][p] = (int32_t)((uint32_t)value[c][p] + top);
		}
}

static void tinted_narrow(int32_t *value, const uint16_t *tint, int count)
{
	for (int n = 0; n < count; n++)
		value[n] = (int32_t)(((int64_t)value[n] * (int16_t)tint[n] + (1 << 14)) >> 15);
}

static void tint_left(int32_t *value, const uint16_t *tint, int count)
{
	kernels_c.tint(value, tint, count / 4 * 4);
}

/* ---- place ---- */

static void row_left(const int32_t *value, const uint16_t row[16], int32_t *to)
{
	uint16_t less[16];

	memcpy(less, row, sizeof(less));
	less[15] &= 0x7fff;
	kernels_c.place(value, less, to);
}

static void wrapped(const int32_t *value, const uint16_t row[16], int32_t *to)
{
	for (int p = 0; p < 256; p++) {
		if (row[p / 16] >> p % 16 & 1)
			to[p] = (int32_t)((uint32_t)to[p] + (uint32_t)*value++);
	}
}

/* ---- grain ---- */

/* Object and noise are added in floating point. */
static void grain_rounded(const struct kernel_grain *tile)
{
	kernels_c.grain(tile);
	for (int c = 0; c < 3; c++)
		for (int i = 0; i < tile->rows * KERNEL_GRAIN; i++) {
			const int32_t object = tile->object[c][i], with = tile->to[c][i];

			tile->to[c][i] = (int32_t)((float)object + (float)(with - object));
		}
}

static void grain_left(const struct kernel_grain *tile)
{
	kernels_c.grain(tile);
	tile->to[2][KERNEL_GRAIN - 1] = tile->object[2][KERNEL_GRAIN - 1];
}

/* Every row gets the first one's noise. */
static void grain_repeated(const struct kernel_grain *tile)
{
	struct kernel_grain one = *tile;

	one.noise_step = 0;
	kernels_c.grain(&one);
}

/* ---- divide ---- */

/* Rounds to the nearest. */
static void divide_rounded(int32_t value[256], const float grid[KERNEL_GRID * KERNEL_GRID])
{
	int32_t half[256];

	for (int p = 0; p < 256; p++)
		half[p] = value[p] + 1;
	kernels_c.divide(half, grid);
	kernels_c.divide(value, grid);
	for (int p = 0; p < 256; p++)
		value[p] = (value[p] + half[p]) / 2;
}

/* The last column of squares reads the point before. */
static void divide_turned(int32_t value[256], const float grid[KERNEL_GRID * KERNEL_GRID])
{
	float other[KERNEL_GRID * KERNEL_GRID];

	memcpy(other, grid, sizeof(other));
	for (int j = 0; j < KERNEL_GRID; j++)
		other[(j + 1) * KERNEL_GRID - 1] = other[(j + 1) * KERNEL_GRID - 2];
	kernels_c.divide(value, other);
}

/* ---- mix ---- */

static void one_too_many(const struct kernel_row *row)
{
	kernels_c.mix(row);
	/* Writes after the first row of several, never after the last: a guard page may be behind
	 * that one. */
	if (row->count % 4 == 3 && row->rows > 1)
		memset(row->out + (ptrdiff_t)row->count * 4, 255, 4);
}

static void one_too_few(const struct kernel_row *row)
{
	struct kernel_row less = *row;

	less.count -= row->count == 65;
	kernels_c.mix(&less);
}

static void not_opaque(const struct kernel_row *row)
{
	kernels_c.mix(row);
	for (int x = 0; x < row->count; x++)
		row->out[x * 4 + 3] = row->background[x * 4 + 3];
}

static void piece_rounded(const struct kernel_row *row)
{
	struct kernel_curves curves = *row->curves;
	struct kernel_row other = *row;

	curves.a[31]--;
	curves.a[13]++;
	other.curves = &curves;
	kernels_c.mix(&other);
}

static void coverage_rounded(const struct kernel_row *row)
{
	static uint16_t coverage[2048];
	struct kernel_row other = *row;
	const int numbers = (row->rows - 1) * (int)row->coverage_step + row->count;

	for (int x = 0; x < numbers && row->coverage; x++)
		coverage[x] = row->coverage[x] == 65535 ? 65534 : row->coverage[x];
	if (row->coverage)
		other.coverage = coverage;
	kernels_c.mix(&other);
}

/* Adds the object where nothing is covered. */
static void object_seen(const struct kernel_row *row)
{
	static const uint16_t none[2048];
	struct kernel_row other = *row;

	if (!row->coverage)
		other.coverage = none;
	kernels_c.mix(&other);
}

static void row_repeated(const struct kernel_row *row)
{
	struct kernel_row other = *row;

	other.background_step = row->rows > 1 ? row->background_step - 4 : 0;
	kernels_c.mix(&other);
}

#define SUMS16_FAULT(f)                                                                            \
	{                                                                                          \
#f, SUMS16,                                                                        \
		{                                                                                  \
			.sums16 = f                                                                \
		}                                                                                  \
	}
#define SUMS8_FAULT(f)                                                                             \
	{                                                                                          \
#f, SUMS8,                                                                         \
		{                                                                                  \
			.sums8 = f                                                                 \
		}                                                                                  \
	}
#define SPLIT_FAULT(f)                                                                             \
	{                                                                                          \
#f, SPLIT,                                                                         \
		{                                                                                  \
			.split = f                                                                 \
		}                                                                                  \
	}
#define PLACE_FAULT(f)                                                                             \
	{                                                                                          \
#f, PLACE,                                                                         \
		{                                                                                  \
			.place = f                                                                 \
		}                                                                                  \
	}
#define VALUES16_FAULT(f)                                                                          \
	{                                                                                          \
#f, VALUES16,                                                                      \
		{                                                                                  \
			.values16 = f                                                              \
		}                                                                                  \
	}
#define VALUES8_FAULT(f)                                                                           \
	{                                                                                          \
#f, VALUES8,                                                                       \
		{                                                                                  \
			.values8 = f                                                               \
		}                                                                                  \
	}
#define TINT_FAULT(f)                                                                              \
	{                                                                                          \
#f, TINT,                                                                          \
		{                                                                                  \
			.tint = f                                                                  \
		}                                                                                  \
	}
#define PROJECT_FAULT(f)                                                                           \
	{                                                                                          \
#f, PROJECT,                                                                       \
		{                                                                                  \
			.project = f                                                               \
		}                                                                                  \
	}
#define FOLD_FAULT(f)                                                                              \
	{                                                                                          \
#f, FOLD,                                                                          \
		{                                                                                  \
			.fold = f                                                                  \
		}                                                                                  \
	}
#define MIX_FAULT(f)                                                                               \
	{                                                                                          \
#f, MIX,                                                                           \
		{                                                                                  \
			.mix = f                                                                   \
		}                                                                                  \
	}

#define GRAIN_FAULT(f)                                                                             \
	{                                                                                          \
#f, GRAIN,                                                                         \
		{                                                                                  \
			.grain = f                                                                 \
		}                                                                                  \
	}

#define DIVIDE_FAULT(f)                                                                            \
	{                                                                                          \
#f, DIVIDE,                                                                        \
		{                                                                                  \
			.divide = f                                                                \
		}                                                                                  \
	}

static const struct faulty faults[] = {
	SUMS16_FAULT(digit_dropped16),
	SUMS16_FAULT(pair_dropped16),
	SUMS16_FAULT(lines_in_order16),
	SUMS16_FAULT(not_added16),
	SUMS16_FAULT(widened_late16),
	SUMS16_FAULT(channel_shared16),
	SUMS8_FAULT(always_added8),
	SUMS8_FAULT(not_shifted8),
	SUMS8_FAULT(stepped_close8),
	SUMS8_FAULT(saturated8),
	SUMS8_FAULT(last_pixel8),
	SUMS8_FAULT(wrote_beyond8),
	VALUES16_FAULT(digit_dropped_values16),
	VALUES16_FAULT(cut16),
	VALUES8_FAULT(always_fresh8),
	VALUES8_FAULT(shift_wrapped8),
	TINT_FAULT(tinted_narrow),
	TINT_FAULT(tint_left),
	SPLIT_FAULT(digit_of_half),
	SPLIT_FAULT(channel_left),
	PLACE_FAULT(row_left),
	PLACE_FAULT(wrapped),
	PROJECT_FAULT(run_dropped),
	PROJECT_FAULT(digits_of_first),
	PROJECT_FAULT(narrow),
	FOLD_FAULT(rounded_down),
	FOLD_FAULT(tail_left),
	FOLD_FAULT(factor_signed),
	FOLD_FAULT(not_clamped),
	MIX_FAULT(one_too_many),
	MIX_FAULT(one_too_few),
	MIX_FAULT(not_opaque),
	MIX_FAULT(piece_rounded),
	MIX_FAULT(coverage_rounded),
	MIX_FAULT(object_seen),
	MIX_FAULT(row_repeated),
	GRAIN_FAULT(grain_rounded),
	GRAIN_FAULT(grain_left),
	GRAIN_FAULT(grain_repeated),
	DIVIDE_FAULT(divide_rounded),
	DIVIDE_FAULT(divide_turned),
};

const int faulty_count = (int)(sizeof(faults) / sizeof(faults[0]));

struct faulty faulty_table(int i)
{
	struct faulty f = faults[i];
	struct kernels table = kernels_c;

	table.name = f.fault;
	table.sums16 = f.table.sums16 ? f.table.sums16 : table.sums16;
	table.sums8 = f.table.sums8 ? f.table.sums8 : table.sums8;
	table.values16 = f.table.values16 ? f.table.values16 : table.values16;
	table.values8 = f.table.values8 ? f.table.values8 : table.values8;
	table.tint = f.table.tint ? f.table.tint : table.tint;
	table.split = f.table.split ? f.table.split : table.split;
	table.place = f.table.place ? f.table.place : table.place;
	table.project = f.table.project ? f.table.project : table.project;
	table.fold = f.table.fold ? f.table.fold : table.fold;
	table.mix = f.table.mix ? f.table.mix : table.mix;
	table.grain = f.table.grain ? f.table.grain : table.grain;
	table.divide = f.table.divide ? f.table.divide : table.divide;
	f.table = table;
	return f;
}
