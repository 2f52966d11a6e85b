/* SPDX-License-Identifier: MIT */
/*
 * Cache of light transport for the surfaces that paths reach after a diffuse bounce.
 *
 * A record stands for points on surfaces that are near to each other and have similar normals. Its
 * row E is the mean over these points of what a white Lambertian surface sends back per unit
 * radiance of each light, by way of as many further surfaces as the bake allows:
 *
 *     E[r][c][i] = open[r][i] + sum over links l of r: weight[l][c] * E[to[l]][c][i]
 *
 * open is the light of cells that are not blocked. A link is a path that goes on from a point in a
 * blocked direction, or below the horizon; its weight contains the colour of the surface where it
 * ends, in record `to`. A surface of colour k sends k[c] * E[r][c][i] towards all directions.
 *
 * Points are where random paths from the camera's first surfaces arrive, so that records are dense
 * where they are used, and a record's mean is that over its uses. All points and their random
 * numbers are functions of seed and index, so that the cache does not depend on threads.
 */
#ifndef INLAY_BAKE_TRACE_CACHE_H
#define INLAY_BAKE_TRACE_CACHE_H

#include "bake/trace/transport.h"
#include "hal/base/pool.h"

/* Records of a large bake; half as many are hardly worse. */
#define CACHE_RECORDS_MAX 2048

struct cache_settings {
	const struct world *world;
	const struct cells *cells;
	int bounces; /* as of transport_create() */
	uint64_t seed;
	int records; /* to make, about; at most CACHE_RECORDS_MAX */
	/* Finds the first surface at a point of the picture, 0..1 each; *direction: of the ray, unit.
	 * Called on one thread. False: none. */
	bool (*look)(void *context, double x, double y, struct surface *surface,
		     struct v3 *direction);
	/* Called on each thread before it works; may be NULL. */
	void (*watch)(void *context, int worker);
	void *context;
};

/* Traces the cache on all threads of the pool. *cache becomes NULL when paths hardly ever meet a
 * second surface, or when few records are asked for: paths are then followed to their ends. World and cells must outlive it.
 * -ENOMEM. */
int cache_create(struct cache **cache, const struct cache_settings *settings, struct pool *pool);
void cache_destroy(struct cache *cache); /* NULL is harmless */

/* Finds the record of a point of a surface. */
int cache_find(const struct cache *cache, const struct surface *surface);

/* E of a record: [3][lights]. */
const float *cache_row(const struct cache *cache, int record);

/* RMS distance of a record's points from their mean. Closer than a few of these, a row says too
 * little of how light changes over the surface. */
float cache_spread(const struct cache *cache, int record);

#endif
