/* SPDX-License-Identifier: MIT */
/*
 * The dome as the tracer uses it: a table of directions in each light, drawn once with the light's
 * weight as density. A cell is any light here, also a tent.
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
	float *reach;	 /* [count]: sine of the largest angle from node to border; 1: >= 90 deg */
	/* [depth][count], each row in the order above: */
	struct v3 *uniform; /* density: solid angle times weight */
	struct v3 *ground;  /* density: projected solid angle times weight, as on flat ground */
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

/* Finds the lights that share a direction, and the weight of each. Returns their number, 0..3; it
 * is 0 below the horizon. */
static inline int cells_weights(const struct cells *cells, struct v3 direction, int light[3],
				float weight[3])
{
	const double d[3] = {direction.x, direction.y, direction.z};
	double exact[3];
	const int count = dome_weights(cells->dome, d, light, exact);

	for (int k = 0; k < count; k++)
		weight[k] = (float)exact[k];
	return count;
}

/* Returns the weight of one light in a direction. */
static inline float cells_weight(const struct cells *cells, int light, struct v3 direction)
{
	const double d[3] = {direction.x, direction.y, direction.z};

	return (float)dome_weight(cells->dome, light, d);
}

#endif
