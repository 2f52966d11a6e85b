/* SPDX-License-Identifier: MIT */
/*
 * What the files of the single instruction sets share. Each is compiled with the flags of its own
 * set (hal/module.mk); nothing else is, and so nothing but its table may be called from outside,
 * after supported() said yes. Private to hal/compositor/kernels*.c.
 */
#ifndef INLAY_HAL_COMPOSITOR_KERNELS_KERNELS_ISA_H
#define INLAY_HAL_COMPOSITOR_KERNELS_KERNELS_ISA_H

#include <string.h>

#include "hal/compositor/kernels/kernels.h"

/* Digits, or the kind of a line, are constants where these are called, so that each case becomes
 * code of its own with its sums in registers. */
#define KERNEL_INLINE static inline __attribute__((always_inline))

/* Loops over what must stay in registers: gcc would else decide too late. */
#define KERNEL_UNROLL _Pragma("GCC unroll 8")

/* Of bytes there may be many more: 4096 * 127 * 2048 < 2^31. */
#define KERNEL_RUN8 4096

/* Products of a lane of int32 before it must be widened: 32 of them in the same sense. */
#define KERNEL_LANE_PRODUCTS 32

#define KERNEL_KEY_BASE (135 << 13) /* of the bits of KERNEL_BLACK */

extern const struct kernels kernels_sse41;
extern const struct kernels kernels_avx2;
extern const struct kernels kernels_avx512;
extern const struct kernels kernels_neon;
extern const struct kernels kernels_neon_dotprod;

/* The specification, for those that have nothing better. */
int kernel_c_split(int64_t (*weight)[KERNEL_WEIGHT], int count, int16_t *digit);
void kernel_c_tint(int32_t *value, const uint16_t *tint, int count);
void kernel_c_place(const int32_t *value, const uint16_t row[16], int32_t *to);

/* In kernels_isa.c, which is compiled for every processor. */
bool kernels_supported_sse41(void);
bool kernels_supported_avx2(void);
bool kernels_supported_avx512(void);
bool kernels_supported_neon(void);
bool kernels_supported_neon_dotprod(void);

/* Two weights that lie side by side, as one number of 32 bits. */
static inline int32_t kernel_weight_pair(const int16_t *digit)
{
	int32_t pair;

	memcpy(&pair, digit, sizeof(pair));
	return pair;
}

/*
 * The planes of three vectors that may have different numbers of digits: where one has less, it is
 * filled up with zeros, so that the loops have no branches.
 */
struct kernel_planes {
	int digits; /* 0: there is nothing but 0 */
	const int16_t *plane[3][KERNEL_DIGITS];
};

extern int16_t kernel_zeros[KERNEL_STRIDE_MAX]; /* never written */

static inline void kernel_planes_fill(struct kernel_planes *p, const struct kernel_vector vector[3])
{
	p->digits = 0;
	for (int c = 0; c < 3; c++) {
		if (vector[c].digits > p->digits)
			p->digits = vector[c].digits;
		for (int d = 0; d < KERNEL_DIGITS; d++)
			p->plane[c][d] = d < vector[c].digits ? vector[c].digit[d] : kernel_zeros;
	}
}

/* How far ahead of a run to ask for lines that follow each other: 4 KiB, more than the processor
 * fetches of itself. Beyond a panel lies the next one. */
#define KERNEL_AHEAD 64

/* Asks for the lines of a run that comes later. Inline by force, as gcc 12 drops calls in which it
 * sees no effect. */
KERNEL_INLINE void kernel_fetch(const void *lines, const struct kernel_weights *w, int from, int to)
{
	const char *first = lines;

	if (from < to && w->step == KERNEL_LINE_BYTES &&
	    w->line[to - 1] - w->line[from] == (uint32_t)(to - 1 - from))
		first += (size_t)KERNEL_AHEAD * KERNEL_LINE_BYTES;
	for (int k = from; k < to; k++)
		__builtin_prefetch(first + w->line[k] * w->step);
}

static inline void kernel_begin(const struct kernel_weights *w, int64_t *const sum[3], int pixels)
{
	for (int c = 0; c < 3 && w->fresh; c++)
		memset(sum[c], 0, (size_t)pixels * sizeof(*sum[c]));
}

static inline int kernel_run_end(const struct kernel_weights *w, int from, bool bytes)
{
	const int run = bytes ? KERNEL_RUN8 : KERNEL_RUN;

	return w->count - from > run ? from + run : w->count;
}

static inline void kernel_row_next(struct kernel_row *row)
{
	for (int c = 0; c < 3; c++) {
		row->object[c] += row->value_step;
		row->taken[c] += row->value_step;
	}
	row->coverage += row->coverage_step;
	row->background += row->background_step;
	row->out += row->out_step;
}

/* The rest of a row, less than a vector, worked upon as a whole one in memory that is ours. */
#define KERNEL_REST 16

struct kernel_rest {
	_Alignas(64) int32_t object[3][KERNEL_REST], taken[3][KERNEL_REST];
	uint16_t coverage[KERNEL_REST];
	uint8_t background[KERNEL_REST * 4], out[KERNEL_REST * 4];
};

static inline void kernel_rest_load(struct kernel_rest *rest, struct kernel_row *all,
				    const struct kernel_row *row, int x)
{
	const size_t count = (size_t)(row->count - x);

	memset(rest, 0, sizeof(*rest));
	*all = (struct kernel_row){
		.count = KERNEL_REST,
		.coverage = rest->coverage,
		.background = rest->background,
		.curves = row->curves,
		.out = rest->out,
	};
	for (int c = 0; c < 3; c++) {
		memcpy(rest->object[c], row->object[c] + x, count * sizeof(int32_t));
		memcpy(rest->taken[c], row->taken[c] + x, count * sizeof(int32_t));
		all->object[c] = rest->object[c];
		all->taken[c] = rest->taken[c];
	}
	memcpy(rest->coverage, row->coverage + x, count * sizeof(uint16_t));
	memcpy(rest->background, row->background + (size_t)x * 4, count * 4);
}

#endif
