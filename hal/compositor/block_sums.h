/* SPDX-License-Identifier: MIT */
/*
 * The sums of one block: its lines times their weights, which depend on the light. Private to
 * hal/compositor.
 */
#ifndef INLAY_HAL_COMPOSITOR_BLOCK_SUMS_H
#define INLAY_HAL_COMPOSITOR_BLOCK_SUMS_H

#include <stdbool.h>

#include "hal/compositor/compositor.h"
#include "hal/compositor/kernels/kernels.h"
#include "hal/compositor/light/light_vector.h"
#include "hal/compositor/lines.h"
#include "hal/compositor/plan.h"

#define BLOCK_PIXELS (BASIS_TILE * BASIS_TILE)

/* Scratch memory of one worker. */
struct block_work {
	int64_t (*y)[3]; /* [patterns]: y_j */
	struct line_set patterns, columns;
	int64_t sum[3][BLOCK_PIXELS] __attribute__((aligned(64)));
	struct fetch next;
	struct compositor_frame counts;
};

int block_work_create(struct block_work *work, const struct basis *basis);
void block_work_free(struct block_work *work); /* zeroed is fine */

/* Resets the counts. Call it before each frame. */
void block_work_begin(struct block_work *work);

/* Input of the functions below, besides the block's plan. */
struct block_request {
	const struct kernels *kernels;
	const struct light_vector *light;
	const struct block_plan *next; /* the next block that will be summed; NULL: unknown */
	bool fresh; /* overwrite sums or values; false: add to those of the block before */
};

/*
 * Computes the exact sums over the lines of a block for each channel c and listed pixel p:
 *     sum[c][p] = 2^fraction * sum over lines of value * light
 * They are in work->sum.
 */
void block_sums(struct block_work *work, const struct block_plan *plan,
		const struct block_request *request, int fraction, const int64_t *sum[3]);

/*
 * Adds the rounded sums of a block of which at most KERNEL_RUN lines of 16 bits count, and at most
 * KERNEL_VALUE_LINES8 of 8 bits, times the light's factor, to value[c][p] (fresh: overwrites). In
 * int32, with this number of fraction bits:
 *     fraction - KERNEL_VALUE_SHIFT16
 * The values must stay below 2^31 in magnitude.
 */
void block_values(struct block_work *work, const struct block_plan *plan,
		  const struct block_request *request, int fraction, int32_t *const value[3]);

#endif
