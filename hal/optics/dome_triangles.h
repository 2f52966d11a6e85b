/* SPDX-License-Identifier: MIT */
/* The flat triangles between a dome's nodes, and from its rim to the horizon (dome_facets.h). */
#ifndef INLAY_HAL_OPTICS_DOME_TRIANGLES_H
#define INLAY_HAL_OPTICS_DOME_TRIANGLES_H

#include "hal/optics/dome_cells.h"
#include "hal/optics/dome_lookup.h"

struct dome_triangles {
	int vertices; /* the nodes, then the feet of some of them */
	double (*vertex)[3];
	int *owner;	  /* the vertex's node: itself, or the node that it is the foot of */
	int count, room;  /* of triangles */
	int (*corner)[3]; /* vertices of each triangle, counter-clockwise from outside */
};

/* 0 or -ENOMEM. The caller frees the triangles, after a failure too. */
int dome_triangles_create(struct dome_triangles *triangles, const struct dome_cells *cells,
			  const struct dome_lookup *lookup, const double (*node)[3], int count);
void dome_triangles_free(struct dome_triangles *triangles); /* idempotent */

#endif
