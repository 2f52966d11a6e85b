/* SPDX-License-Identifier: MIT */
/*
 * Decodes a layer of a basis, tile by tile, to plain numbers for each light.
 */
#ifndef INLAY_HAL_MEASURE_UNPACKED_H
#define INLAY_HAL_MEASURE_UNPACKED_H

#include <stdbool.h>

#include "hal/basis/basis.h"

#define UNPACKED_PIXELS (BASIS_TILE * BASIS_TILE)

/* The values of one tile, per unit of L_i. Pixel p is y * BASIS_TILE + x. */
struct unpacked {
	int lights;
	float (*object)[UNPACKED_PIXELS]; /* [3 * lights]: t, premultiplied by coverage */
	float (*unlit)[UNPACKED_PIXELS];  /* [3 * lights]: u, the receiver without the object */
	float (*taken)[UNPACKED_PIXELS];  /* [3 * lights]: d = u - s */
	bool is_object[UNPACKED_PIXELS], is_receiver[UNPACKED_PIXELS];
};

int unpacked_create(struct unpacked *unpacked, const struct basis *basis); /* -ENOMEM */
void unpacked_free(struct unpacked *unpacked); /* idempotent; zeroed is fine */

/* Fills in a tile. Channel c of light i is row c * lights + i. */
void unpacked_fill(struct unpacked *unpacked, const struct basis *basis,
		   const struct basis_tile *tile);

#endif
