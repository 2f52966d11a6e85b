/* SPDX-License-Identifier: MIT */
/*
 * The dome as the tracer uses it: for each light, be it a cell or a tent, a set of directions,
 * drawn once with its weight as density. What is said of cells here is meant of tents, too.
 *
 * Sample s of a pixel takes direction s ^ key of every cell, key a hash of the pixel. Samples of
 * one pixel then fill each cell evenly (the directions are a (0,m,2)-net, scrambled cell by cell),
 * and what one sample takes lies side by side in memory, in an order in which neighbours are
 * neighbours in the sky: rays that go together meet the same things.
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
	int depth;	 /* directions a cell; a power of two */
	int *order;	 /* [count]: the cell at each place of a row of directions */
	struct v3 *node; /* [count] */
	float *sr;	 /* [count] solid angle */
	float *share;	 /* [count] projected solid angle / pi: sums to 1 */
	float *reach; /* [count] sine of the largest angle between node and border; 1: beyond 90 deg
		       */
	/* [depth][count], a row in the order above: */
	struct v3 *uniform; /* by solid angle times weight */
	struct v3 *ground;  /* by projected solid angle times weight: what flat ground gets */
};

int cells_create(struct cells *cells, const struct dome *dome);
void cells_free(struct cells *cells); /* idempotent; zeroed is fine */

/* The row of directions that a sample takes; pixel: a hash. */
static inline const struct v3 *cells_pick(const struct cells *cells, const struct v3 *table,
					  uint32_t pixel, uint32_t sample)
{
	return table +
	       (size_t)((sample ^ pixel) & (uint32_t)(cells->depth - 1)) * (size_t)cells->count;
}

/* The lights that an escaping ray reads, and how much of each: none below the horizon. */
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

/* That of one light. */
static inline float cells_weight(const struct cells *cells, int light, struct v3 direction)
{
	const double d[3] = {direction.x, direction.y, direction.z};

	return (float)dome_weight(cells->dome, light, d);
}

#endif
