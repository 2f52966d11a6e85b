/* SPDX-License-Identifier: MIT */
/*
 * The coarse lights: the nodes of a dome of lower frequency, each fine light shared out among the
 * three of them that it lies between.
 */
#ifndef INLAY_BAKE_ENCODE_COARSE_H
#define INLAY_BAKE_ENCODE_COARSE_H

#include "hal/basis/basis_format.h"
#include "hal/optics/dome.h"

/* The coarse dome's frequency where nobody says otherwise: at most this. */
#define COARSE_FREQUENCY 9

/*
 * gather: [fine->count]. The weights are barycentric in the plane triangle of the coarse nodes
 * around the light, where it lies in one, and of the nearest point of such triangles where it is
 * outside all of them (near the horizon, where the coarse dome may end above it); they sum to
 * BASIS_COARSE_ONE.
 */
void coarse_fill(const struct dome *fine, const struct dome *coarse, struct basis_coarse *gather);

#endif
