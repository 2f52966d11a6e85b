/* SPDX-License-Identifier: MIT */
/* The nodes of a geodesic dome at or above the horizon, in the order of lights (dome.h). */
#ifndef INLAY_HAL_OPTICS_DOME_NODES_H
#define INLAY_HAL_OPTICS_DOME_NODES_H

#include "hal/optics/dome.h"

/* Number of nodes; frequency in 1..DOME_FREQUENCY_MAX. */
int dome_node_count(int frequency);

/* Fills direction[dome_node_count()]. 0 or -ENOMEM. */
int dome_nodes_fill(int frequency, double (*direction)[3]);

/* Makes the nodes of a dome with finer parts (dome.h), which the caller frees. The parts are valid.
 * -ENOMEM. */
int dome_nodes_create(int frequency, const struct dome_fine *fine, int parts,
		      double (**direction)[3], int *count);

#endif
