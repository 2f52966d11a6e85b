/*
 * The dome as the tracer uses it: for each cell a set of directions, drawn once.
 *
 * Sample s of a pixel takes direction s ^ key of each cell, key a hash of pixel and cell: samples
 * of one pixel then fill each cell evenly (the directions are a (0,m,2)-net), and neighbouring
 * pixels and cells are independent of each other.
 */
#ifndef INLAY_BAKE_CELLS_H
#define INLAY_BAKE_CELLS_H

#include <stdint.h>

#include "bake/vec3.h"
#include "hal/optics/dome.h"

struct cells {
	const struct dome *dome; /* not owned */
	int count;
	int depth;	    /* directions a cell; a power of two */
	struct v3 *node;    /* [count] */
	float *sr;	    /* [count] solid angle */
	float *share;	    /* [count] projected solid angle / pi: sums to 1 */
	float *reach;	    /* [count] sine of the largest angle between node and border */
	struct v3 *uniform; /* [count][depth], uniform by solid angle */
	struct v3 *ground; /* [count][depth], by projected solid angle: what flat ground receives */
};

int cells_create(struct cells *cells, const struct dome *dome);
void cells_free(struct cells *cells); /* idempotent; zeroed is fine */

/* Which of a cell's directions a sample takes. */
static inline int cells_pick(const struct cells *cells, int cell, uint32_t pixel, uint32_t sample)
{
	uint32_t key = (pixel + (uint32_t)cell) * UINT32_C(0x9e3779b1);

	key ^= key >> 15;
	key *= UINT32_C(0x85ebca77);
	key ^= key >> 13;
	return cell * cells->depth + (int)((sample ^ key) & (uint32_t)(cells->depth - 1));
}

/* The cell that an escaping ray reads, or -1 below the horizon. */
static inline int cells_of(const struct cells *cells, struct v3 direction)
{
	const double d[3] = {direction.x, direction.y, direction.z};

	return dome_cell_of(cells->dome, d);
}

#endif
