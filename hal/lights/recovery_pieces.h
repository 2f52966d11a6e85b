/* SPDX-License-Identifier: MIT */
/*
 * Groups clipped lights into connected pieces of sky: two clipped lights whose cells share an edge
 * are in one piece. A lamp is a piece, and so is a window, whatever number of lights it covers.
 */
#ifndef INLAY_HAL_LIGHTS_RECOVERY_PIECES_H
#define INLAY_HAL_LIGHTS_RECOVERY_PIECES_H

#include "hal/optics/dome.h"

struct clipped_pieces;

/* The dome is not needed afterwards. 0 or -ENOMEM. */
int clipped_pieces_create(struct clipped_pieces **pieces, const struct dome *dome);

/* clipped[lights]: share of each light's pixels that is clipped, 0..1. Returns [lights]: the
 * clipped solid angle of the light's piece in sr, 0 for lights that are not clipped; valid until
 * the next call. Allocates nothing; takes linear time. */
const double *clipped_pieces_find(struct clipped_pieces *pieces, const float *clipped);

void clipped_pieces_destroy(struct clipped_pieces *pieces); /* NULL is harmless */

#endif
