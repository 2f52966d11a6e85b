/* SPDX-License-Identifier: MIT */
/*
 * The sums of one block: its lines times what the light makes of them. Private to hal/compositor.
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

/* What one worker needs for it. */
struct block_work {
	int64_t (*y)[3]; /* of patterns */
	struct line_set patterns, columns;
	int64_t *now[3]; /* [patterns + columns]: of kept blocks, what each line weighs now */
	int64_t sum[3][BLOCK_PIXELS] __attribute__((aligned(64)));
	struct fetch next;
	struct compositor_frame counts;
};

int block_work_create(struct block_work *work, const struct basis *basis);
void block_work_free(struct block_work *work); /* zeroed is fine */

/* Before each frame. */
void block_work_begin(struct block_work *work);

/* Sums of the frame before, of blocks that keep them. */
struct kept_block {
	bool valid;   /* holds the frame before's */
	int fraction; /* of that */
};

struct kept_sums {
	int64_t *values;	   /* [layer_plan's kept_size]; NULL: nothing is kept */
	struct kept_block *blocks; /* [blocks of the layer] */
	bool always;		   /* even where it costs more */
};

struct block_request {
	const struct kernels *kernels;
	const struct light_vector *light;
	const struct kept_sums *kept;
	/* What will be summed next, and what after that; NULL: not known. */
	const struct block_plan *next, *after;
	int kept_index; /* of this block in kept->blocks */
	bool fresh;	/* sums or values are 0, whatever the block before left there */
};

/*
 * sum[c][p] of the block's pixels: value per unit of light times the light, with `fraction` more
 * bits; in work->sum, on top of what the block before left there unless it is fresh, or, of kept
 * blocks, where they are kept. Exact integers whichever way they come.
 */
void block_sums(struct block_work *work, const struct block_plan *plan,
		const struct block_request *request, int fraction, const int64_t *sum[3]);

/*
 * Of a block of which at most KERNEL_RUN lines count: the same times the light's factor, rounded to
 * KERNEL_VALUE_SHIFT16 bits less than `fraction`, added to the values of the pixels that it lists.
 * What they come to is below 2^31 in magnitude. Nothing is kept.
 */
void block_values(struct block_work *work, const struct block_plan *plan,
		  const struct block_request *request, int fraction, int32_t *const value[3]);

#endif
