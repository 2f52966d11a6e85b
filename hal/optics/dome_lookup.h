/* SPDX-License-Identifier: MIT */
/* Finds what lies in a direction, such as the nearest node, in constant time: a grid over the
 * hemisphere lists the candidates in each grid cell. */
#ifndef INLAY_HAL_OPTICS_DOME_LOOKUP_H
#define INLAY_HAL_OPTICS_DOME_LOOKUP_H

#include "hal/optics/dome_cells.h"

/* Creates a lookup of count items; item i lies in a cap of radius[i] (rad) around centre[i] (unit,
 * z >= 0). 0 or -ENOMEM. */
int dome_lookup_create(struct dome_lookup **lookup, const double *radius, const double (*centre)[3],
		       int count);
void dome_lookup_destroy(struct dome_lookup *lookup); /* NULL is harmless */

/* All items whose cap holds dir, and some more, in ascending order. None below the horizon and for
 * an invalid dir. */
const int *dome_lookup_candidates(const struct dome_lookup *lookup, const double dir[3],
				  int *count);

/* The item whose centre is nearest to dir; node: the centres given at creation. -1: none. */
int dome_lookup_find(const struct dome_lookup *lookup, const double (*node)[3],
		     const double dir[3]);

#endif
