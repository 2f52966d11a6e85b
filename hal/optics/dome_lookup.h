/* SPDX-License-Identifier: MIT */
/* What lies in a direction, such as the nearest node: a grid on the hemisphere, and for each of its
 * cells what can be the answer there. */
#ifndef INLAY_HAL_OPTICS_DOME_LOOKUP_H
#define INLAY_HAL_OPTICS_DOME_LOOKUP_H

#include "hal/optics/dome_cells.h"

/* Of count things, each within a cap of this radius (rad) around a centre (unit, z >= 0). */
int dome_lookup_create(struct dome_lookup **lookup, const double *radius, const double (*centre)[3],
		       int count);
void dome_lookup_destroy(struct dome_lookup *lookup); /* NULL is harmless */

/* All whose cap holds dir, and some more, ascending. None below the horizon and for no direction.
 */
const int *dome_lookup_candidates(const struct dome_lookup *lookup, const double dir[3],
				  int *count);

/* The nearest of the centres. */
int dome_lookup_find(const struct dome_lookup *lookup, const double (*node)[3],
		     const double dir[3]);

#endif
