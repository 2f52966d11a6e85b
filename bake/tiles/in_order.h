/* SPDX-License-Identifier: MIT */
/* Makes tiles on all threads, and hands them on in ascending order. A sample of them is made first
 * and waits in memory, so that the progress knows what the others cost (strata.h). */
#ifndef INLAY_BAKE_TILES_IN_ORDER_H
#define INLAY_BAKE_TILES_IN_ORDER_H

#include "bake/base/progress.h"
#include "bake/tiles/finished_tile.h"
#include "hal/base/fault.h"
#include "hal/base/pool.h"

struct in_order {
	int tiles;
	int tiles_after; /* tiles of later runs, which the progress includes */
	/* Sums over earlier runs of rays and of struct finished_tile.seconds. */
	uint64_t rays_before;
	double seconds_before;
	void *context;
	/* Makes tile number index, 0..tiles-1, on thread worker. Called on several threads at
	 * once. */
	int (*make)(void *context, int index, int worker, struct finished_tile *tile,
		    struct fault *fault);
	/* Takes the tiles one at a time, in ascending order; they are freed afterwards. */
	int (*take)(void *context, const struct finished_tile *tile, struct fault *fault);
	struct progress *progress; /* already begun */
};

/* Returns 0, or the error of the first call that fails; the other threads then stop. */
int in_order_run(const struct in_order *work, struct pool *pool, struct fault *fault);

#endif
