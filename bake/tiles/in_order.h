/* SPDX-License-Identifier: MIT */
/* Tiles that all threads make, in any order, handed on in theirs. */
#ifndef INLAY_BAKE_TILES_IN_ORDER_H
#define INLAY_BAKE_TILES_IN_ORDER_H

#include "bake/base/progress.h"
#include "bake/tiles/finished_tile.h"
#include "hal/base/fault.h"
#include "hal/base/pool.h"

struct in_order {
	int tiles;
	int tiles_before; /* that the progress has seen, with their rays */
	uint64_t rays_before;
	void *context;
	/* Makes the index-th, for thread worker. */
	int (*make)(void *context, int index, int worker, struct finished_tile *tile,
		    struct fault *fault);
	/* Gets each, one at a time, in ascending order. */
	int (*take)(void *context, const struct finished_tile *tile, struct fault *fault);
	struct progress *progress; /* begun */
};

/* Ends with the first that fails, and what it returned. */
int in_order_run(const struct in_order *work, struct pool *pool, struct fault *fault);

#endif
