/* SPDX-License-Identifier: MIT */
/*
 * Declarations shared by the files of all instruction sets. Each of these files is compiled with
 * the flags of its set (hal/module.mk), and no other file is. So other code may only call the
 * functions in its table, after supported() has returned true. Private to this folder.
 */
#ifndef INLAY_HAL_COMPOSITOR_KERNELS_KERNELS_ISA_H
#define INLAY_HAL_COMPOSITOR_KERNELS_KERNELS_ISA_H

#include <string.h>

#include "hal/compositor/kernels/kernels.h"

/* Forces inlining. Callers pass the number of digits and the kind of line as constants, so each
 * case is compiled on its own, with its sums in registers. */
#define KERNEL_INLINE static inline __attribute__((always_inline))

/* Unrolls loops over arrays that must be in registers; gcc decides too late by itself. */
#define KERNEL_UNROLL _Pragma("GCC unroll 8")

/* The same as KERNEL_RUN for bytes: 4096 * 127 * 2048 < 2^31. */
#define KERNEL_RUN8 4096

/* Products that a lane of int32 can sum before it must be widened: 32 * 32767 * 2048 < 2^31. */
#define KERNEL_LANE_PRODUCTS 32

#define KERNEL_KEY_BASE (135 << 13) /* the bits of KERNEL_BLACK, shifted right by 10 */

extern const struct kernels kernels_sse41;
extern const struct kernels kernels_avx2;
extern const struct kernels kernels_avx512;
extern const struct kernels kernels_neon;
extern const struct kernels kernels_neon_dotprod;

/* Functions of kernels_c.c that other tables borrow. */
int kernel_c_split(int64_t (*weight)[KERNEL_WEIGHT], int count, int16_t *digit);
void kernel_c_tint(int32_t *value, const uint16_t *tint, int count);
void kernel_c_place(const int32_t *value, const uint16_t row[16], int32_t *to);

/* Sets recode and steady of curves whose pieces are set. */
void kernel_c_find_steady(struct kernel_curves *curves);

/* In kernels_isa.c, which is compiled for every processor. */
bool kernels_supported_sse41(void);
bool kernels_supported_avx2(void);
bool kernels_supported_avx512(void);
bool kernels_supported_neon(void);
bool kernels_supported_neon_dotprod(void);

/* Two adjacent weights as one number of 32 bits. */
static inline int32_t kernel_weight_pair(const int16_t *digit)
{
	int32_t pair;

	memcpy(&pair, digit, sizeof(pair));
	return pair;
}

/*
 * The digit planes of three vectors. A vector with fewer digits than another gets planes of zeros,
 * so that loops have no branches.
 */
struct kernel_planes {
	int digits; /* largest number of digits; 0: all vectors are 0 */
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

/* Prefetch distance in lines for consecutive lines: 4 KiB, more than the processor prefetches by
 * itself. The next panel follows a panel in memory. */
#define KERNEL_AHEAD 64

/* Prefetches the lines of a later run. Forced inline because gcc 12 drops calls of functions that
 * only prefetch. */
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
	if (row->coverage)
		row->coverage += row->coverage_step;
	row->background += row->background_step;
	row->out += row->out_step;
}

/* Copy of the last pixels of a row, fewer than a vector, padded to a whole vector. */
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
		.coverage = row->coverage ? rest->coverage : NULL,
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
	if (row->coverage)
		memcpy(rest->coverage, row->coverage + x, count * sizeof(uint16_t));
	memcpy(rest->background, row->background + (size_t)x * 4, count * 4);
}

#endif
