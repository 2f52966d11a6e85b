/* SPDX-License-Identifier: MIT */
/*
 * Sums that blocks keep from frame to frame: a frame adds only line * (new weight - old weight).
 * Private to hal/compositor.
 */
#ifndef INLAY_HAL_COMPOSITOR_KEPT_SUMS_H
#define INLAY_HAL_COMPOSITOR_KEPT_SUMS_H

#include "hal/compositor/block_sums.h"

/*
 * Both functions update the kept sums of a block and set sum[] to them. kept_sums_step() computes
 * only the weights of lights that changed; it returns false, without effect, if the block is not
 * one column for each light or has no usable sums. kept_sums_take() uses the weights in work's
 * sets.
 */
bool kept_sums_step(struct block_work *work, const struct block_plan *plan,
		    const struct block_request *request, int fraction, int64_t *sum[3]);
void kept_sums_take(struct block_work *work, const struct block_plan *plan,
		    const struct block_request *request, int fraction, int64_t *sum[3]);

#endif
