#include "tests/kernels/compare.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/kernels/guarded.h"

#define LINES 40	   /* of a panel; weights name them again and again */
#define WEIGHTS_LONG 70000 /* more than any kernel may add up without widening */
#define WEIGHTS 2000
#define STRIDE_MAX 4096
#define ROWS 9
#define WIDTH 300

const char *const kernel_function_names[FUNCTIONS] = {"sums16", "sums8", "project", "fold", "mix"};

struct comparison {
	uint64_t state;
	int round;
	struct guarded lines, line, digit[3][KERNEL_DIGITS], out[2]; /* out: truth's, other's */
	struct guarded object[3], taken[3], coverage, background;
	struct kernel_curves curves[TRANSFER_COUNT][TRANSFER_COUNT];
};

/* ---- numbers ---- */

static uint64_t next(struct comparison *c) /* splitmix64 */
{
	uint64_t x = c->state += UINT64_C(0x9e3779b97f4a7c15);

	x = (x ^ x >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
	x = (x ^ x >> 27) * UINT64_C(0x94d049bb133111eb);
	return x ^ x >> 31;
}

static int below(struct comparison *c, int n)
{
	return (int)(next(c) % (uint64_t)n);
}

static int between(struct comparison *c, int low, int high)
{
	return low + below(c, high - low + 1);
}

/* Of any size up to 2^bits - 1, small ones as often as large ones. */
static int64_t spread(struct comparison *c, int bits)
{
	const int64_t x = (int64_t)(next(c) >> 1 >> (63 - below(c, bits + 1)));

	return below(c, 2) ? x : -x;
}

/* How an array of numbers in low..high is made. */
enum filling { RANDOM, LOWEST, HIGHEST, EXTREMES, ALTERNATING, ZEROS, FILLINGS };

static int value(struct comparison *c, enum filling filling, int i, int low, int high)
{
	switch (filling) {
	case LOWEST:
		return low;
	case HIGHEST:
		return high;
	case EXTREMES:
		return below(c, 2) ? low : high;
	case ALTERNATING:
		return i % 2 ? low : high;
	case ZEROS:
		return 0;
	default:
		return between(c, low, high);
	}
}

static void fill16(struct comparison *c, void *to, int count, int low, int high)
{
	const enum filling filling = (enum filling)below(c, FILLINGS);
	int16_t *x = to;

	for (int i = 0; i < count; i++)
		x[i] = (int16_t)value(c, filling, i, low, high);
}

/* ---- sums16, sums8 ---- */

static int weights_count(struct comparison *c)
{
	if (c->round == 0)
		return WEIGHTS_LONG;
	if (c->round < 40) /* every short one: the ends of runs */
		return 2 * c->round - 2;
	return 2 * below(c, (c->round % 8 ? 100 : WEIGHTS) / 2 + 1);
}

static struct kernel_weights make_weights(struct comparison *c)
{
	const bool ordered = below(c, 2);
	struct kernel_weights w = {.count = weights_count(c),
				   .digits = between(c, 1, KERNEL_DIGITS)};
	uint32_t *line = guarded_take(&c->line, (size_t)w.count * sizeof(*line));

	for (int k = 0; k < w.count; k++)
		line[k] = (uint32_t)(ordered ? k % LINES : below(c, LINES));
	w.line = line;
	for (int d = 0; d < w.digits; d++) {
		int16_t *digit = guarded_take(&c->digit[0][d], (size_t)w.count * sizeof(*digit));

		fill16(c, digit, w.count, -2048, 2047);
		if (c->round == 0) { /* what overflows first */
			for (int k = 0; k < w.count; k++)
				digit[k] = d % 2 ? 2047 : -2048;
		}
		w.digit[d] = digit;
	}
	return w;
}

static bool sums(struct comparison *c, bool bytes, const struct kernels *tables[2], char *why)
{
	const int pixels = bytes ? KERNEL_LINE8 : KERNEL_LINE16;
	const int beyond = below(c, 8); /* numbers after the sums, so that these lie anywhere */
	const size_t size = (size_t)(pixels + beyond) * sizeof(int64_t);
	void *lines = guarded_take(&c->lines, LINES * KERNEL_LINE_BYTES);
	const enum filling filling = c->round == 0 ? HIGHEST : (enum filling)below(c, FILLINGS);
	const struct kernel_weights w = make_weights(c);
	int64_t *sum[2];

	for (int i = 0; i < LINES * pixels; i++) {
		if (bytes)
			((int8_t *)lines)[i] = (int8_t)value(c, filling, i, -127, 127);
		else
			((int16_t *)lines)[i] = (int16_t)value(c, filling, i, -32767, 32767);
	}
	for (int i = 0; i < 2; i++)
		sum[i] = guarded_take(&c->out[i], size);
	for (int p = 0; p < pixels + beyond; p++)
		sum[0][p] = sum[1][p] = spread(c, 61);
	for (int i = 0; i < 2; i++) {
		if (bytes)
			tables[i]->sums8(lines, &w, sum[i]);
		else
			tables[i]->sums16(lines, &w, sum[i]);
	}
	for (int p = 0; p < pixels + beyond; p++) {
		if (sum[0][p] != sum[1][p]) {
			snprintf(why, 256,
				 "%d weights of %d digits, pixel %d: %" PRId64
				 ", expected %" PRId64,
				 w.count, w.digits, p, sum[1][p], sum[0][p]);
			return false;
		}
	}
	return guarded_intact(&c->out[1], size);
}

/* ---- project ---- */

static bool project(struct comparison *c, const struct kernels *tables[2], char *why)
{
	const int stride = 32 * (c->round < 40 ? c->round + 1 : between(c, 1, STRIDE_MAX / 32));
	const int count = below(c, ROWS + 1);
	const size_t size = (size_t)count * 3 * sizeof(int64_t);
	const bool same = below(c, 2);
	const int digits = below(c, KERNEL_DIGITS + 1);
	struct kernel_vector vector[3];
	int16_t *rows = guarded_take(&c->lines, (size_t)(count * stride) * sizeof(*rows));
	int64_t(*y[2])[3];

	fill16(c, rows, count * stride, -32767, 32767);
	for (int k = 0; k < 3; k++) {
		vector[k].digits = same ? digits : below(c, KERNEL_DIGITS + 1);
		for (int d = 0; d < KERNEL_DIGITS; d++) {
			void *plane = guarded_take(&c->digit[k][d], (size_t)stride * 2);

			/* What is beyond its digits must not count. */
			fill16(c, plane, stride, -2048, 2047);
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

/* ---- fold ---- */

/* A sum, often where its rounding or its clamping turns. */
static int64_t fold_sum(struct comparison *c, int shift)
{
	const int64_t limit = INT64_C(1) << 62;
	const int64_t unit = INT64_C(1) << (shift - 1); /* half of what is rounded to */
	int64_t x = spread(c, 62);

	switch (below(c, 6)) {
	case 0: /* ties, and beside them */
		x = x / unit * unit + between(c, -1, 1);
		break;
	case 1: /* where it is clamped; where int32 ends */
		if (shift < 31)
			x = (below(c, 2) ? KERNEL_LIMIT : INT64_C(0x7fffffff)) * unit * 2 +
			    between(c, -2, 2) * unit;
		x = below(c, 2) ? x : -x;
		break;
	case 2:
		x = below(c, 2) ? limit : -limit;
		break;
	default:
		break;
	}
	return x > limit ? limit : x < -limit ? -limit : x;
}

static uint32_t fold_factor(struct comparison *c)
{
	static const uint32_t ends[] = {0, 1, 1U << 30, (1U << 30) - 1, (1U << 31) - 1, 1U << 31};
	const int which = below(c, 12);

	return which < 6 ? ends[which] : (uint32_t)(next(c) >> 33 >> below(c, 31));
}

static int32_t fold_to(struct comparison *c)
{
	switch (below(c, 4)) {
	case 0:
		return below(c, 2) ? KERNEL_LIMIT : -KERNEL_LIMIT;
	case 1:
		return below(c, 2) ? INT32_MAX : INT32_MIN;
	default:
		return (int32_t)spread(c, 31);
	}
}

static bool fold(struct comparison *c, const struct kernels *tables[2], char *why)
{
	const int count = c->round < 256 ? c->round + 1 : between(c, 1, 256);
	const int shift = between(c, 1, 62);
	const uint32_t factor = fold_factor(c);
	const size_t size = (size_t)count * sizeof(int32_t);
	int64_t *sum = guarded_take(&c->lines, (size_t)count * sizeof(*sum));
	uint16_t *tint = guarded_take(&c->coverage, (size_t)count * sizeof(*tint));
	const bool tinted = below(c, 2), dark = below(c, 2);
	int32_t *to[2];

	for (int i = 0; i < 2; i++)
		to[i] = guarded_take(&c->out[i], size);
	for (int p = 0; p < count; p++) {
		sum[p] = fold_sum(c, shift);
		tint[p] = (uint16_t)(next(c) % (dark ? 32769 : 65536));
		if (below(c, 4) == 0)
			tint[p] = dark || below(c, 2) ? 32768 : 65535;
		to[0][p] = to[1][p] = fold_to(c);
	}
	for (int i = 0; i < 2; i++)
		tables[i]->fold(sum, count, shift, factor, tinted ? tint : NULL, to[i]);
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

/* ---- mix ---- */

static int32_t mix_taken(struct comparison *c)
{
	static const int32_t ends[] = {0,	  1 << 24,   (1 << 24) + 1, -15 * (1 << 24),
				       INT32_MIN, INT32_MAX, (1 << 24) - 1, -15 * (1 << 24) - 1};

	return below(c, 3) ? (int32_t)spread(c, 26) : ends[below(c, 8)];
}

static uint16_t mix_coverage(struct comparison *c)
{
	static const uint16_t ends[] = {0, 65535, 32767, 32768};

	return below(c, 2) ? (uint16_t)next(c) : ends[below(c, 4)];
}

static struct kernel_row make_row(struct comparison *c, int count)
{
	struct kernel_row row = {.count = count};
	uint16_t *coverage = guarded_take(&c->coverage, (size_t)count * sizeof(*coverage));
	uint8_t *background = guarded_take(&c->background, (size_t)count * 4);

	for (int k = 0; k < 3; k++) {
		int32_t *object = guarded_take(&c->object[k], (size_t)count * sizeof(*object));
		int32_t *taken = guarded_take(&c->taken[k], (size_t)count * sizeof(*taken));

		for (int x = 0; x < count; x++) {
			object[x] = below(c, 2)	  ? (int32_t)spread(c, 25)
				    : below(c, 8) ? 0
						  : (below(c, 2) ? INT32_MAX : INT32_MIN);
			taken[x] = mix_taken(c);
		}
		row.object[k] = object;
		row.taken[k] = taken;
	}
	for (int x = 0; x < count; x++)
		coverage[x] = mix_coverage(c);
	for (int i = 0; i < count * 4; i++)
		background[i] = (uint8_t)next(c);
	row.coverage = coverage;
	row.background = background;
	row.curves = &c->curves[below(c, TRANSFER_COUNT)][below(c, TRANSFER_COUNT)];
	return row;
}

static bool mix(struct comparison *c, const struct kernels *tables[2], char *why)
{
	const int count = c->round < 132 ? c->round / 2 : between(c, 1, WIDTH);
	const int beyond = below(c, 20); /* pixels after the row, to be left alone; else a wall */
	const size_t size = (size_t)(count + beyond) * 4;
	struct kernel_row row = make_row(c, count);
	uint8_t *out[2];

	for (int i = 0; i < 2; i++) {
		out[i] = guarded_take(&c->out[i], size);
		memset(out[i], 0x3c, size);
		row.out = out[i];
		tables[i]->mix(&row);
	}
	for (size_t i = 0; i < size; i++) {
		if (out[0][i] != out[1][i]) {
			snprintf(why, 256, "byte %zu of %d pixels: %d, expected %d", i, count,
				 out[1][i], out[0][i]);
			return false;
		}
	}
	return guarded_intact(&c->out[1], size);
}

/* ---- all of them ---- */

struct comparison *comparison_create(uint64_t seed)
{
	struct comparison *c = NULL;

	if (posix_memalign((void **)&c, 64, sizeof(*c)) != 0)
		exit(1);
	memset(c, 0, sizeof(*c));
	c->state = seed;
	guarded_create(&c->lines, (size_t)ROWS * STRIDE_MAX * 2);
	guarded_create(&c->line, WEIGHTS_LONG * sizeof(uint32_t));
	for (int k = 0; k < 3; k++) {
		for (int d = 0; d < KERNEL_DIGITS; d++)
			guarded_create(&c->digit[k][d], WEIGHTS_LONG * sizeof(int16_t));
		guarded_create(&c->object[k], WIDTH * sizeof(int32_t));
		guarded_create(&c->taken[k], WIDTH * sizeof(int32_t));
	}
	for (int i = 0; i < 2; i++)
		guarded_create(&c->out[i], 8192);
	guarded_create(&c->coverage, WIDTH * sizeof(uint16_t));
	guarded_create(&c->background, WIDTH * 4);
	for (int from = 0; from < TRANSFER_COUNT; from++) {
		for (int to = 0; to < TRANSFER_COUNT; to++)
			kernel_curves_fill(&c->curves[from][to], (enum transfer)from,
					   (enum transfer)to);
	}
	return c;
}

void comparison_free(struct comparison *c)
{
	guarded_free(&c->lines);
	guarded_free(&c->line);
	for (int k = 0; k < 3; k++) {
		for (int d = 0; d < KERNEL_DIGITS; d++)
			guarded_free(&c->digit[k][d]);
		guarded_free(&c->object[k]);
		guarded_free(&c->taken[k]);
	}
	for (int i = 0; i < 2; i++)
		guarded_free(&c->out[i]);
	guarded_free(&c->coverage);
	guarded_free(&c->background);
	free(c);
}

static bool one_round(struct comparison *c, enum kernel_function function,
		      const struct kernels *tables[2], char *why)
{
	switch (function) {
	case SUMS16:
		return sums(c, false, tables, why);
	case SUMS8:
		return sums(c, true, tables, why);
	case PROJECT:
		return project(c, tables, why);
	case FOLD:
		return fold(c, tables, why);
	default:
		return mix(c, tables, why);
	}
}

bool comparison_run(struct comparison *c, enum kernel_function function, int rounds,
		    const struct kernels *truth, const struct kernels *other, char why[256])
{
	const struct kernels *tables[2] = {truth, other};

	for (c->round = 0; c->round < rounds; c->round++) {
		strcpy(why, "it wrote before its output");
		if (!one_round(c, function, tables, why))
			return false;
	}
	return true;
}
