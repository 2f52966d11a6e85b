/* SPDX-License-Identifier: MIT */
/*
 * Cache of light transport for the surfaces that paths reach after a diffuse bounce.
 *
 * A record stands for points on surfaces that are near to each other and have similar normals. Its
 * row E is the mean over these points of the radiance that leaves a white Lambertian surface per
 * unit radiance of each light, with as many further bounces as the bake allows:
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
#include "bake/trace/world.h"
#include "hal/base/pool.h"

/* The key of a surface point in the tree of records: its place relative to the objects' bounding
 * sphere (distances beyond that are compressed to at most 2), its normal, and its kind of
 * surface. */
#define CACHE_AXES 7

struct cache_key {
	float axis[CACHE_AXES];
};

/* A node of the tree. */
struct cache_split {
	int axis;
	float at;     /* keys above this belong to the second child */
	int child[2]; /* nodes; below 0: ~record */
};

struct cache {
	struct bounds bounds; /* a sphere around the objects */
	int lights, records;
	struct cache_split *split; /* [records - 1]: the first one is the root */
	float *spread;		   /* [records]: cache_spread() */
	float *row;		   /* [records][3][lights] */
};

struct cache_key cache_key_of(const struct cache *cache, const struct surface *surface);

/* Finds the record of a point of a surface. */
int cache_find(const struct cache *cache, const struct surface *surface);

/* Returns E of a record: [3][lights]. */
const float *cache_row(const struct cache *cache, int record);

/* Returns the RMS distance of a record's points from their mean. Within a few of these distances
 * light may change more over the surface than the record's one row can show. */
float cache_spread(const struct cache *cache, int record);

/* Frees what cache_create() has made. NULL is harmless. */
void cache_destroy(struct cache *cache);

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
