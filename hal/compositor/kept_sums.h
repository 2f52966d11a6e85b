/* SPDX-License-Identifier: MIT */
/*
 * Sums that blocks keep from frame to frame. Private to hal/compositor.
 */
#ifndef INLAY_HAL_COMPOSITOR_KEPT_SUMS_H
#define INLAY_HAL_COMPOSITOR_KEPT_SUMS_H

#include "hal/compositor/block_sums.h"

/*
 * Both leave the sums where they are kept. The first is for blocks whose columns are all lights: it
 * needs no weights but those of lights that changed, and returns false where it does not serve. The
 * second takes the weights from the work's sets.
 */
bool kept_sums_step(struct block_work *work, const struct block_plan *plan,
		    const struct block_request *request, int fraction, int64_t *sum[3]);
void kept_sums_take(struct block_work *work, const struct block_plan *plan,
		    const struct block_request *request, int fraction, int64_t *sum[3]);

#endif
