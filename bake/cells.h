/*
 * The dome as the tracer uses it: for each cell a set of directions, drawn once.
 *
 * Sample s of a pixel takes direction s ^ key of every cell, key a hash of the pixel. Samples of
 * one pixel then fill each cell evenly (the directions are a (0,m,2)-net, scrambled cell by cell),
 * and what one sample takes lies side by side in memory, in an order in which neighbours are
 * neighbours in the sky: rays that go together meet the same things.
 */
#ifndef INLAY_BAKE_CELLS_H
#define INLAY_BAKE_CELLS_H

#include <stddef.h>
#include <stdint.h>

#include "bake/vec3.h"
#include "hal/optics/dome.h"

struct cells {
	const struct dome *dome; /* not owned */
	int count;
	int depth;	 /* directions a cell; a power of two */
	int *order;	 /* [count]: the cell at each place of a row of directions */
	struct v3 *node; /* [count] */
	float *sr;	 /* [count] solid angle */
	float *share;	 /* [count] projected solid angle / pi: sums to 1 */
	float *reach;	 /* [count] sine of the largest angle between node and border */
	/* [depth][count], a row in the order above: */
	struct v3 *uniform; /* uniform by solid angle */
	struct v3 *ground;  /* by projected solid angle: what flat ground receives */
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

/* The cell that an escaping ray reads, or -1 below the horizon. */
static inline int cells_of(const struct cells *cells, struct v3 direction)
{
	const double d[3] = {direction.x, direction.y, direction.z};

	return dome_cell_of(cells->dome, d);
}

#endif
