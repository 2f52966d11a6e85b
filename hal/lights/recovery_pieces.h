/* SPDX-License-Identifier: MIT */
/*
 * Which clipped lights belong together: two whose cells share an edge are of one piece of the sky,
 * and so are all that hang together by such pairs. A lamp is a piece, and so is a window, whatever
 * number of lights it covers.
 */
#ifndef INLAY_HAL_LIGHTS_RECOVERY_PIECES_H
#define INLAY_HAL_LIGHTS_RECOVERY_PIECES_H

#include "hal/optics/dome.h"

struct clipped_pieces;

/* The dome is not needed afterwards. 0 or -ENOMEM. */
int clipped_pieces_create(struct clipped_pieces **pieces, const struct dome *dome);

/* clipped[lights]: share of each light's pixels that is clipped, 0..1. Returns [lights]: the solid
 * angle, in sr, of all that is clipped in the light's piece, 0 of a light that is not clipped.
 * Valid until the next. Nothing is allocated; linear in the lights. */
const double *clipped_pieces_find(struct clipped_pieces *pieces, const float *clipped);

void clipped_pieces_destroy(struct clipped_pieces *pieces); /* NULL is harmless */

#endif
