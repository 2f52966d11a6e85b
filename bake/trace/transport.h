/* SPDX-License-Identifier: MIT */
/*
 * Path tracing for all lights at once: a path yields a row of N transport coefficients, not one
 * colour.
 *
 * At the first two surfaces of a path a ray goes to every cell above the surface. Cells that are
 * not blocked add their light. One of the blocked rays, drawn with a probability in proportion to
 * its weight, is followed and carries the weight of all blocked ones. So blocked and bounced light
 * balance in each sample, and a white object in a white furnace vanishes at any number of samples.
 * A ray to a cell goes on through glass, straight or bent, and gets the light of the sky that it
 * reaches; only the share that the glass mirrors counts as blocked. At further surfaces the same is
 * done with a few cosine-weighted, stratified directions.
 */
#ifndef INLAY_BAKE_TRACE_TRANSPORT_H
#define INLAY_BAKE_TRACE_TRANSPORT_H

#include <stddef.h>
#include <stdint.h>

#include "bake/base/vec3.h"
#include "bake/trace/world.h"
#include "hal/optics/dome.h"

/*
 * The dome as the tracer uses it: a table of directions in each cell, drawn once.
 *
 * Sample s of a pixel takes direction `s ^ key` of every cell, where key is a hash of the pixel.
 * Samples of one pixel then fill each cell evenly, as the directions are a (0,m,2)-net, scrambled
 * cell by cell. The directions of one sample lie side by side in memory, in an order in which
 * neighbours are neighbours in the sky, so that rays traced together meet the same surfaces.
 */

struct cells {
	const struct dome *dome; /* not owned */
	int count;
	int depth;	 /* directions in each cell; a power of two */
	int *order;	 /* [count]: the cell at each place of a row of directions */
	struct v3 *node; /* [count]: direction of the cell's node */
	float *sr;	 /* [count]: solid angle */
	float *share;	 /* [count]: projected solid angle / pi; sums to 1 */
	/* [count]: share, and of glossy ground what its coat mirrors: u of the ground is its
	 * albedo times this */
	float *shown;
	float *reach; /* [count]: sine of the largest angle from node to border; 1: >= 90 deg */
	/* [depth][count], each row in the order above: */
	struct v3 *uniform; /* density: solid angle */
	struct v3 *ground;  /* density: projected solid angle, as on flat ground */
};

/* The dome must outlive the cells. -ENOMEM. */
int cells_create(struct cells *cells, const struct dome *dome);
void cells_free(struct cells *cells); /* idempotent; zeroed is fine */

/* Returns a sample's row of directions. table is uniform or ground; pixel is a hash of the
 * pixel. */
static inline const struct v3 *cells_pick(const struct cells *cells, const struct v3 *table,
					  uint32_t pixel, uint32_t sample)
{
	return table +
	       (size_t)((sample ^ pixel) & (uint32_t)(cells->depth - 1)) * (size_t)cells->count;
}

/* Returns the cell of a direction; -1 below the horizon. */
static inline int cells_of(const struct cells *cells, struct v3 direction)
{
	const double d[3] = {direction.x, direction.y, direction.z};

	return dome_cell_of(cells->dome, d);
}

struct cache;

/* The end of a path in a record of the cache (cache.h). */
struct transport_link {
	int record;
	struct rgb weight;
};

/* Guesses that find blocked rays sooner; the result does not depend on them. */
struct transport_guess {
	struct ray_batch rays; /* rays that meet no ball inside an object (inside.c) */
	int *index;	       /* [WORLD_RAYS_MAX]: index of each in struct transport's rays */
	uint8_t *ball;	       /* [count]: the ball that an earlier ray to this cell met */
	uint8_t *stopped;      /* [count]: the last ray to this cell that met none was blocked */
};

/* State of one thread. */
struct transport {
	const struct world *world;
	const struct cells *cells;
	int bounces;	/* surfaces after the first that a path may visit */
	int directions; /* rays at a further surface; a power of two */
	struct v3 *fan; /* [TRANSPORT_FANS][directions]: cosine-weighted around +Z */
	struct ray_batch rays;
	struct transport_guess guess;
	int *cell;    /* [WORLD_RAYS_MAX]: the cell or fan direction of each ray in the batch */
	float *value; /* [count]: weight of each cell's ray */
	struct random random;
	/* State of the current camera sample. */
	uint32_t pixel, sample; /* choose one of a cell's directions */
	float choice;		/* chooses the blocked ray to follow from the first surface, 0..1 */
	double below[2];	/* chooses the direction below the horizon, 0..1 */
	/* Draws the coat of the next glossy surface, all of it: no ray to a cell shows it as well;
	 * state 0: not in use. */
	struct random coat;
	bool compared; /* the sample is traced with either presence, and subtracted */
	/* Above 0: the path is about to meet glass, and the light that passes it is added already,
	 * so that only this share, which the glass mirrors, is left. 0: all light is left. */
	float mirrored;
	uint64_t ray_count; /* rays so far */
	/* The cache gives the light of surfaces that a path reaches after a diffuse bounce; NULL:
	 * the path goes on. The caller sets and owns it. */
	const struct cache *cache;
	bool gathered;		     /* the path has had a diffuse bounce ... */
	struct v3 gathered_at;	     /* ... the last of them here */
	struct transport_link *link; /* [links_max]: filled by transport_link(); NULL: not in use */
	int links, links_max;
};

#define TRANSPORT_FANS 256

/* World and cells must outlive it. -ENOMEM. */
int transport_create(struct transport *transport, const struct world *world,
		     const struct cells *cells, int bounces);
void transport_free(struct transport *transport); /* idempotent; zeroed is fine */

/* Begins a camera sample: all its random numbers follow from these three. */
void transport_begin(struct transport *transport, uint64_t seed, uint32_t pixel, uint32_t sample);

/* The rows that a sample adds to. Light that met exactly one surface has a row of its own, as it is
 * sharp and almost without noise, while the rest is smooth and noisy. Clear glass before the first
 * other surface does not count. */
struct transport_rows {
	/* [3][count]: light of one surface; for a shadow [transport_shadow_channels()][count] */
	float *direct;
	float *bounce; /* [3][count]: light of several surfaces */
};

/*
 * Adds weight times the radiance that leaves a surface towards wo per unit radiance of each cell.
 * Two calls with either presence, each after the same transport_begin(), use the same random
 * numbers, so that their rows differ only by the effect of the objects.
 */
void transport_add(struct transport *transport, enum presence presence,
		   const struct surface *surface, struct v3 wo, struct rgb weight,
		   const struct transport_rows *rows);

/* Adds weight times the radiance that comes from a direction of the sky. */
void transport_add_sky(struct transport *transport, struct v3 direction, struct rgb weight,
		       const struct transport_rows *rows);

/* Returns the number of channels of direct light that a shadow takes away: 3 if panes are tinted,
 * else 1. */
int transport_shadow_channels(const struct world *world);

/*
 * Adds weight times the light of each cell that objects take away from flat ground, in scenes
 * without stand-ins:
 *     direct[c][i] += 1 for each cell that is blocked; 1 - transmission behind panes
 *     bounce[c][i] += (u - s) / albedo of the light that objects throw on the ground (<= 0)
 * Cells that no path over an object reaches stay unchanged. Returns false when nothing was added.
 */
bool transport_add_shadow(struct transport *transport, struct v3 position, float weight,
			  const struct transport_rows *rows);

/*
 * Tells whether the coat of glossy ground, at its next random numbers, mirrors an object towards
 * wo. The background's picture does not show such a sample, as it has what the coat mirrors without
 * the object: transport_add_mirrored() adds the ground's own light, with the object in its coat.
 */
bool transport_mirrors_object(struct transport *transport, const struct surface *ground,
			      struct v3 wo);
void transport_add_mirrored(struct transport *transport, const struct surface *ground, struct v3 wo,
			    const struct transport_rows *rows);

/*
 * Traces one point of a record of the cache: adds to row [3][count] what the surface reflects of
 * each cell, and appends to link the ends of the paths that go on from it. Light that these paths
 * collect on their way, by coats and glass, is added to row.
 */
void transport_link(struct transport *transport, const struct surface *surface, float *row);

#endif
