/* SPDX-License-Identifier: MIT */
/* Makes the cache of bounced light (cache.h): finds points, groups them into records, traces their
 * rows. */
#ifndef INLAY_BAKE_TRACE_CACHE_MAKE_H
#define INLAY_BAKE_TRACE_CACHE_MAKE_H

#include "bake/trace/cache.h"
#include "bake/trace/transport.h"
#include "hal/base/pool.h"

/* A large bake has this many records; half as many are hardly worse. */
#define CACHE_RECORDS_MAX 2048

struct cache_settings {
	const struct world *world;
	const struct cells *cells;
	int bounces; /* as in transport_create() */
	uint64_t seed;
	int records; /* about as many are made; at most CACHE_RECORDS_MAX */
	/* Finds the first surface at a point of the picture, 0..1 each; *direction becomes the
	 * ray's unit direction. Returns false if there is none. It is called on one thread. */
	bool (*look)(void *context, double x, double y, struct surface *surface,
		     struct v3 *direction);
	void *context;
};

/* Traces the cache on all threads of the pool. *cache becomes NULL when paths hardly ever meet a
 * second surface, or when few records are asked for: paths are then followed to their ends. World
 * and cells must outlive it. Memory: 25 MB at 1,000 lights, 134 MB at most. -ENOMEM. */
int cache_create(struct cache **cache, const struct cache_settings *settings, struct pool *pool);

#endif
