/* SPDX-License-Identifier: MIT */
/*
 * Lines of a block times their weights. Private to hal/compositor.
 */
#ifndef INLAY_HAL_COMPOSITOR_LINES_H
#define INLAY_HAL_COMPOSITOR_LINES_H

#include <stdbool.h>
#include <stddef.h>

#include "hal/basis/basis.h"
#include "hal/compositor/fetch.h"
#include "hal/compositor/kernels/kernels.h"

/* Lines to be read, and their weights split into digits. */
struct line_set {
	int count;
	uint32_t *line; /* of columns of 8 bits that were chosen, where their records begin */
	bool records;	/* that is so */
	int64_t (*weight)[KERNEL_WEIGHT];
	int16_t *digit;
	struct kernel_weights kernel; /* digits is 0 where all weights are */
	/* Of columns: their records, and lines of one panel as kernels read them. */
	struct record_place {
		const uint8_t *code, *line;
	} * at;
	int8_t *unpacked; /* [3][count] lines */
	uint32_t *number; /* 0, 1, 2... */
};

int line_set_create(struct line_set *set, size_t most, bool columns);
void line_set_free(struct line_set *set); /* zeroed is fine */

/* Fills the digits from the weights, and the count up to an even one. */
void line_set_split(struct line_set *set, const struct kernels *kernels);

/* What lines are added to, pixel by pixel of a block: exact sums, or rounded values. */
struct line_target {
	int64_t *sum[3];
	int32_t *value[3]; /* NULL: sums */
};

/* Adds patterns and columns of a block to its pixels, all of which are 0 if fresh, whatever stands
 * there. columns have weights with `shift` bits less. To values: at most KERNEL_RUN of either, and
 * `shift` is what kernels.h has for them. Returns how many bytes were read. While it adds it
 * fetches. */
size_t lines_add(const struct kernels *kernels, const struct basis_block *b,
		 struct line_set *patterns, struct line_set *columns, int shift, bool fresh,
		 struct fetch *fetch, const struct line_target *to);

#endif
