/* SPDX-License-Identifier: MIT */
/*
 * The coarse lights: the nodes of a dome of lower frequency. Each fine light is distributed over
 * the three coarse nodes around it.
 */
#ifndef INLAY_BAKE_TILES_COARSE_H
#define INLAY_BAKE_TILES_COARSE_H

#include "hal/basis/basis_format.h"
#include "hal/optics/dome.h"

/* Default frequency of the coarse dome. */
#define COARSE_FREQUENCY 9

/*
 * Sets gather [fine->count]. The weights are barycentric in the plane triangle of coarse nodes
 * around the light. Near the horizon the coarse dome may end above a light, which is then outside
 * of all triangles and has the weights of the nearest point of one. Weights sum to
 * BASIS_COARSE_ONE.
 */
void coarse_fill(const struct dome *fine, const struct dome *coarse, struct basis_coarse *gather);

#endif
