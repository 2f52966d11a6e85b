/* SPDX-License-Identifier: MIT */
/*
 * Weights of a direction between the nodes around it, which are continuous and sum to 1: the
 * barycentric ones in the flat triangle (facet) that its ray meets.
 *
 * The facets are those of the nodes' convex hull that face upwards, the dual of the cells. The
 * lowest nodes may lie above the horizon; there, triangles between the hull's rim and the horizon
 * close the gap. Their lower corners are the feet, the points of the horizon straight below the
 * rim's nodes. A foot belongs to its node, so two nodes share each direction below the rim.
 */
#ifndef INLAY_HAL_OPTICS_DOME_FACETS_H
#define INLAY_HAL_OPTICS_DOME_FACETS_H

#include "hal/optics/dome_cells.h"
#include "hal/optics/dome_lookup.h"

struct dome_facets;

/* Creates the facets of count nodes from their cells and the lookup of these cells. 0; -ENOMEM;
 * -EINVAL: the triangles do not cover the hemisphere. */
int dome_facets_create(struct dome_facets **facets, const struct dome_cells *cells,
		       const struct dome_lookup *lookup, const double (*node)[3], int count);
void dome_facets_destroy(struct dome_facets *facets); /* NULL is harmless */

/* Lists the nodes with a weight > 0 in a direction; returns their number, 1 to 3; 0 below the
 * horizon (z < 0) and for an invalid dir (zero, NaN, infinity). dir need not be unit. It is fast
 * where dir is in a facet around that node. *facet is tried first, and becomes the facet that was
 * found; -1: none is known. */
int dome_facets_weights(const struct dome_facets *facets, int node, int *facet, const double dir[3],
			int to[3], double weight[3]);

#endif
