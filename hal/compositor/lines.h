/* SPDX-License-Identifier: MIT */
/*
 * Adds up the lines of a block times their weights. Private to hal/compositor.
 */
#ifndef INLAY_HAL_COMPOSITOR_LINES_H
#define INLAY_HAL_COMPOSITOR_LINES_H

#include <stdbool.h>
#include <stddef.h>

#include "hal/basis/basis.h"
#include "hal/compositor/fetch.h"
#include "hal/compositor/kernels/kernels.h"

/* The lines to read, and their weights, also split into digits. */
struct line_set {
	int count;
	uint32_t *line; /* line numbers, or offsets of records */
	bool records;	/* line[] holds offsets of records: 8-bit columns that were chosen */
	int64_t (*weight)[KERNEL_WEIGHT];
	int16_t *digit;
	struct kernel_weights kernel; /* digits is 0 if all weights are 0 */
	/* For 8-bit columns: their records, and unpacked lines of one panel for the kernels. */
	struct record_place {
		const uint8_t *code, *line;
	} * at;
	int8_t *unpacked; /* [3][count] lines */
	uint32_t *number; /* 0, 1, 2...: numbers of the unpacked lines */
};

/* most: largest count; columns: with room for 8-bit columns. set is zeroed. -ENOMEM. */
int line_set_create(struct line_set *set, size_t most, bool columns);
void line_set_free(struct line_set *set); /* zeroed is fine */

/* Splits the weights into digits; adds a line of weight 0 if the count is odd. */
void line_set_split(struct line_set *set, const struct kernels *kernels);

/* The sums or rounded values of a block's pixels, to which lines are added. */
struct line_target {
	int64_t *sum[3];
	int32_t *value[3]; /* NULL: sums */
};

/* Adds patterns and columns of a block to its pixels. fresh: overwrites them instead. Weights of
 * columns have `shift` fraction bits less than those of patterns if sums are asked for. Values
 * allow at most KERNEL_RUN patterns and as many columns, or KERNEL_VALUE_LINES8 of 8 bits, whose
 * weights have KERNEL_VALUE_SHIFT16 - KERNEL_VALUE_SHIFT8 fraction bits less, whatever `shift`.
 * Prefetches meanwhile. Returns the number of bytes read. */
size_t lines_add(const struct kernels *kernels, const struct basis_block *b,
		 struct line_set *patterns, struct line_set *columns, int shift, bool fresh,
		 struct fetch *fetch, const struct line_target *to);

#endif
