#include "tests/kernels/faults.h"

#include <string.h>

/* ---- sums ---- */

static void digit_dropped16(const int16_t *lines, const struct kernel_weights *w, int64_t *sum)
{
	struct kernel_weights less = *w;

	less.digits = w->digits == KERNEL_DIGITS ? KERNEL_DIGITS - 1 : w->digits;
	kernels_c.sums16(lines, &less, sum);
}

static void pair_dropped16(const int16_t *lines, const struct kernel_weights *w, int64_t *sum)
{
	struct kernel_weights less = *w;

	less.count = w->count / 4 * 4;
	kernels_c.sums16(lines, &less, sum);
}

static void lines_in_order16(const int16_t *lines, const struct kernel_weights *w, int64_t *sum)
{
	struct kernel_weights other = *w;
	static uint32_t line[1024];

	for (uint32_t i = 0; i < 1024; i++)
		line[i] = i % 40;
	if (w->count <= 1024)
		other.line = line;
	kernels_c.sums16(lines, &other, sum);
}

static void not_added16(const int16_t *lines, const struct kernel_weights *w, int64_t *sum)
{
	memset(sum, 0, KERNEL_LINE16 * sizeof(*sum));
	kernels_c.sums16(lines, w, sum);
}

/* Adds up lines in int32 for longer than their products fit. */
static void widened_late16(const int16_t *lines, const struct kernel_weights *w, int64_t *sum)
{
	for (int d = 0; d < w->digits; d++) {
		for (int p = 0; p < KERNEL_LINE16; p++) {
			for (int from = 0; from < w->count; from += 34) {
				uint32_t part = 0;

				for (int k = from; k < w->count && k < from + 34; k++)
					part += (uint32_t)(lines[w->line[k] * KERNEL_LINE16 +
								 (uint32_t)p] *
							   w->digit[d][k]);
				sum[p] = (int64_t)((uint64_t)sum[p] +
						   ((uint64_t)(int64_t)(int32_t)part
						    << d * KERNEL_DIGIT_BITS));
			}
		}
	}
}

/* The low byte of each digit by the instruction that adds two products of bytes in 16 bits. */
static void saturated8(const int8_t *lines, const struct kernel_weights *w, int64_t *sum)
{
	for (int d = 0; d < w->digits; d++) {
		for (int p = 0; p < KERNEL_LINE8; p++) {
			for (int k = 0; k < w->count; k += 2) {
				int64_t pair = 0, rest = 0;

				for (int i = 0; i < 2; i++) {
					const int digit = w->digit[d][k + i], low = (int8_t)digit;
					const int x =
						lines[w->line[k + i] * KERNEL_LINE8 + (uint32_t)p];

					pair += (x + 128) * low;
					rest += x * (digit - low) - 128 * low;
				}
				pair = pair > 32767 ? 32767 : pair < -32768 ? -32768 : pair;
				sum[p] = (int64_t)((uint64_t)sum[p] + ((uint64_t)(pair + rest)
								       << d * KERNEL_DIGIT_BITS));
			}
		}
	}
}

static void last_pixel8(const int8_t *lines, const struct kernel_weights *w, int64_t *sum)
{
	const int64_t last = sum[KERNEL_LINE8 - 1];

	kernels_c.sums8(lines, w, sum);
	if (w->count > 1000)
		sum[KERNEL_LINE8 - 1] = last;
}

static void wrote_beyond8(const int8_t *lines, const struct kernel_weights *w, int64_t *sum)
{
	kernels_c.sums8(lines, w, sum);
	sum[-1]++;
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
			 const uint16_t *tint, int32_t *to)
{
	for (int p = 0; p < count; p++) {
		const int64_t down = sum[p] & -(INT64_C(1) << shift);

		kernels_c.fold(&down, 1, shift, factor, tint ? tint + p : NULL, to + p);
	}
}

static void tail_left(const int64_t *sum, int count, int shift, uint32_t factor,
		      const uint16_t *tint, int32_t *to)
{
	kernels_c.fold(sum, count > 8 ? count & ~1 : count, shift, factor, tint, to);
}

static void factor_signed(const int64_t *sum, int count, int shift, uint32_t factor,
			  const uint16_t *tint, int32_t *to)
{
	kernels_c.fold(sum, count, shift, factor >> 31 ? 0 : factor, tint, to);
}

static void not_clamped(const int64_t *sum, int count, int shift, uint32_t factor,
			const uint16_t *tint, int32_t *to)
{
	for (int p = 0; p < count; p++) {
		int32_t x = 0;

		kernels_c.fold(sum + p, 1, shift, factor, tint ? tint + p : NULL, &x);
		to[p] = (int32_t)((uint32_t)to[p] + (uint32_t)x);
	}
}

/* ---- mix ---- */

static void one_too_many(const struct kernel_row *row)
{
	kernels_c.mix(row);
	if (row->count % 4 == 3)
		memset(row->out + (size_t)row->count * 4, 255, 4);
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
	uint16_t coverage[512];
	struct kernel_row other = *row;

	for (int x = 0; x < row->count; x++)
		coverage[x] = row->coverage[x] == 65535 ? 65534 : row->coverage[x];
	other.coverage = coverage;
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

static const struct faulty faults[] = {
	SUMS16_FAULT(digit_dropped16),	SUMS16_FAULT(pair_dropped16),
	SUMS16_FAULT(lines_in_order16), SUMS16_FAULT(not_added16),
	SUMS16_FAULT(widened_late16),	SUMS8_FAULT(saturated8),
	SUMS8_FAULT(last_pixel8),	SUMS8_FAULT(wrote_beyond8),
	PROJECT_FAULT(run_dropped),	PROJECT_FAULT(digits_of_first),
	PROJECT_FAULT(narrow),		FOLD_FAULT(rounded_down),
	FOLD_FAULT(tail_left),		FOLD_FAULT(factor_signed),
	FOLD_FAULT(not_clamped),	MIX_FAULT(one_too_many),
	MIX_FAULT(one_too_few),		MIX_FAULT(not_opaque),
	MIX_FAULT(piece_rounded),	MIX_FAULT(coverage_rounded),
};

const int faulty_count = (int)(sizeof(faults) / sizeof(faults[0]));

struct faulty faulty_table(int i)
{
	struct faulty f = faults[i];
	struct kernels table = kernels_c;

	table.name = f.fault;
	table.sums16 = f.table.sums16 ? f.table.sums16 : table.sums16;
	table.sums8 = f.table.sums8 ? f.table.sums8 : table.sums8;
	table.project = f.table.project ? f.table.project : table.project;
	table.fold = f.table.fold ? f.table.fold : table.fold;
	table.mix = f.table.mix ? f.table.mix : table.mix;
	f.table = table;
	return f;
}
