/*
 * Lines of a block times their weights. Private to hal/compositor.
 */
#ifndef INLAY_HAL_COMPOSITOR_LINES_H
#define INLAY_HAL_COMPOSITOR_LINES_H

#include <stdbool.h>
#include <stddef.h>

#include "hal/basis/basis.h"
#include "hal/compositor/fetch.h"
#include "hal/compositor/kernels.h"

/* Lines to be read, and their weights split into digits. */
struct line_set {
	int count;
	uint32_t *line;
	int64_t *weight[3];
	int16_t *digit;
	struct kernel_weights kernel; /* digits is 0 where all weights are */
};

int line_set_create(struct line_set *set, size_t most);
void line_set_free(struct line_set *set); /* zeroed is fine */

/* Fills the digits from the weights, and the count up to an even one. */
void line_set_split(struct line_set *set, const struct kernels *kernels);

/* Adds patterns and columns of a block to the sums of its pixels, which are all 0 if fresh,
 * whatever stands there. columns have weights with `shift` bits less. Returns how many bytes were
 * read. While it adds it fetches. */
size_t lines_add(const struct kernels *kernels, const struct basis_block *b,
		 const struct line_set *patterns, const struct line_set *columns, int shift,
		 bool fresh, struct fetch *fetch, int64_t *sum[3]);

#endif
