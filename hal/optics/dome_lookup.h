/* Which node is nearest to a direction: a grid on the hemisphere, and for each of its cells the
 * nodes that can be the answer there. */
#ifndef INLAY_HAL_OPTICS_DOME_LOOKUP_H
#define INLAY_HAL_OPTICS_DOME_LOOKUP_H

#include "hal/optics/dome_cells.h"

int dome_lookup_create(struct dome_lookup **lookup, const struct dome_cells *cells,
		       const double (*node)[3], int count);
void dome_lookup_destroy(struct dome_lookup *lookup); /* NULL is harmless */

int dome_lookup_find(const struct dome_lookup *lookup, const double (*node)[3],
		     const double dir[3]);

#endif
