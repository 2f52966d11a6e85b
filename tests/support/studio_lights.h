/* SPDX-License-Identifier: MIT */
/* The true light of the simulated studio. */
#ifndef INLAY_TESTS_SUPPORT_STUDIO_LIGHTS_H
#define INLAY_TESTS_SUPPORT_STUDIO_LIGHTS_H

#include "drivers/sim/sim.h"
#include "hal/optics/dome.h"

/* Computes the true radiance[dome->count] of each light: the mean over its Voronoi cell,
 * integrated to about 1e-3 of the brightest. 0 or -ENOMEM. */
int studio_lights(const struct dome *dome, const double origin[3], const struct studio_lamps *lamps,
		  double (*radiance)[3]);

#endif
