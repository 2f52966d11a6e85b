/* SPDX-License-Identifier: MIT */
/*
 * All lights at once: one path yields a row of N transport coefficients, not one colour.
 *
 * At the first two surfaces a ray goes to every cell above them. Cells that are not blocked give
 * their light; one of the blocked rays, chosen with a chance in proportion to its weight, is
 * followed and carries the weight of all blocked ones. So what is blocked and what is bounced
 * balance sample by sample, and a white object in a white furnace vanishes whatever the number of
 * samples. At further surfaces the same is done with a few directions, cosine-weighted and
 * stratified.
 */
#ifndef INLAY_BAKE_TRACE_TRANSPORT_H
#define INLAY_BAKE_TRACE_TRANSPORT_H

#include "bake/trace/cells.h"
#include "bake/trace/world.h"

/* Of one thread. */
struct transport {
	const struct world *world;
	const struct cells *cells;
	int bounces;	/* surfaces after the first that a path may visit */
	int directions; /* at a further surface; a power of two */
	struct v3 *fan; /* [TRANSPORT_FANS][directions]: cosine-weighted around +Z */
	struct ray_batch rays;
	int *cell;    /* [WORLD_RAYS_MAX]: the cell or fan direction of a ray in the batch */
	float *value; /* [count] */
	struct random random;
	/* Of a sample: */
	uint32_t pixel, sample; /* which of a cell's directions to take */
	float choice;		/* which blocked ray to follow from the first surface, 0..1 */
	double below[2];	/* which direction below the horizon, 0..1 */
	bool compared;		/* it will be traced again with other things around it */
	uint64_t ray_count;
};

#define TRANSPORT_FANS 256

int transport_create(struct transport *transport, const struct world *world,
		     const struct cells *cells, int bounces);
void transport_free(struct transport *transport); /* idempotent; zeroed is fine */

/* Before each camera sample: everything random about it follows from these three. */
void transport_begin(struct transport *transport, uint64_t seed, uint32_t pixel, uint32_t sample);

/* What one sample adds to. Light that met exactly one surface is apart from the rest: the first is
 * sharp and almost without noise, the second smooth and noisy. Clear glass before the first other
 * surface does not count. */
struct transport_rows {
	float *direct; /* [3][count]; of a shadow [count] */
	float *bounce; /* [3][count] */
};

/*
 * Adds the radiance that leaves a surface towards wo for each cell's unit radiance, times weight.
 * Called twice after transport_begin() with either presence, the rows differ only by what the
 * objects do.
 */
void transport_add(struct transport *transport, enum presence presence,
		   const struct surface *surface, struct v3 wo, struct rgb weight,
		   const struct transport_rows *rows);

/* Adds the radiance that comes from a direction of the sky, times weight. */
void transport_add_sky(struct transport *transport, struct v3 direction, struct rgb weight,
		       const struct transport_rows *rows);

/*
 * What the objects take away from each cell's light on flat ground where no stand-in is, times
 * weight: to direct 1 for each cell that is blocked, to bounce (u - s) / albedo of the light that
 * objects throw on the ground (not above 0). Both stay as they are for cells that no path through
 * an object concerns. Returns false when nothing was added.
 */
bool transport_add_shadow(struct transport *transport, struct v3 position, float weight,
			  const struct transport_rows *rows);

#endif
