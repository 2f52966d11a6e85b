/* SPDX-License-Identifier: MIT */
/*
 * The dome as the tracer uses it: a table of directions in each cell, drawn once.
 *
 * Sample s of a pixel takes direction `s ^ key` of every cell, where key is a hash of the pixel.
 * Samples of one pixel then fill each cell evenly, as the directions are a (0,m,2)-net, scrambled
 * cell by cell. The directions of one sample lie side by side in memory, in an order in which
 * neighbours are neighbours in the sky, so that rays traced together meet the same surfaces.
 */
#ifndef INLAY_BAKE_TRACE_CELLS_H
#define INLAY_BAKE_TRACE_CELLS_H

#include <stddef.h>
#include <stdint.h>

#include "bake/base/vec3.h"
#include "hal/optics/dome.h"

struct cells {
	const struct dome *dome; /* not owned */
	int count;
	int depth;	 /* directions in each cell; a power of two */
	int *order;	 /* [count]: the cell at each place of a row of directions */
	struct v3 *node; /* [count]: direction of the cell's node */
	float *sr;	 /* [count]: solid angle */
	float *share;	 /* [count]: projected solid angle / pi; sums to 1 */
	/* [count]: share, and of glossy ground what its coat mirrors, for an albedo of 1; the
	 * ground's u is albedo times this */
	float *shown;
	float *reach;	 /* [count]: sine of the largest angle from node to border; 1: >= 90 deg */
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

#endif
