/* SPDX-License-Identifier: MIT */
#include "bake/trace/cache.h"

#include <stdlib.h>

/* A turn of the normal by one radian counts as a distance of this many radii of the bounding
 * sphere. Chosen by trial. */
#define NORMAL_SCALE 0.25f

struct cache_key cache_key_of(const struct cache *cache, const struct surface *s)
{
	struct v3 p = v3_scale(v3_sub(s->position, cache->bounds.centre), 1 / cache->bounds.radius);
	const float distance = v3_length(p);

	if (distance > 1)
		p = v3_scale(p, (2 - 1 / distance) / distance);
	return (struct cache_key){{p.x, p.y, p.z, NORMAL_SCALE * s->normal.x,
				   NORMAL_SCALE * s->normal.y, NORMAL_SCALE * s->normal.z,
				   (float)s->kind}};
}

int cache_find(const struct cache *cache, const struct surface *surface)
{
	const struct cache_key key = cache_key_of(cache, surface);
	int node = 0;

	do {
		const struct cache_split *split = &cache->split[node];

		node = split->child[key.axis[split->axis] > split->at];
	} while (node >= 0);
	return ~node;
}

const float *cache_row(const struct cache *cache, int record)
{
	return cache->row + (size_t)record * 3 * (size_t)cache->lights;
}

float cache_spread(const struct cache *cache, int record)
{
	return cache->spread[record];
}

void cache_destroy(struct cache *cache)
{
	if (!cache)
		return;
	free(cache->split);
	free(cache->spread);
	free(cache->row);
	free(cache);
}
