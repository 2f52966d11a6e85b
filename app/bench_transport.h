/*
 * What a layer of a basis holds, tile by tile, as plain numbers: light by light, however it is
 * encoded. For bench alone.
 */
#ifndef INLAY_APP_BENCH_TRANSPORT_H
#define INLAY_APP_BENCH_TRANSPORT_H

#include <stdbool.h>

#include "hal/basis/basis.h"

#define TRANSPORT_PIXELS (BASIS_TILE * BASIS_TILE)

/* Of one tile; pixel p is y * BASIS_TILE + x. Everything is per unit of L_i. */
struct transport {
	int lights;
	float (*object)[TRANSPORT_PIXELS]; /* [3 * lights]: t, premultiplied by coverage */
	float (*unlit)[TRANSPORT_PIXELS];  /* [3 * lights]: u, the receiver without the object */
	float (*taken)[TRANSPORT_PIXELS];  /* [3 * lights]: d = u - s */
	bool is_object[TRANSPORT_PIXELS], is_receiver[TRANSPORT_PIXELS];
};

int transport_create(struct transport *transport, const struct basis *basis); /* -ENOMEM */
void transport_free(struct transport *transport); /* idempotent; zeroed is fine */

/* Channel c of light i is row c * lights + i. */
void transport_fill(struct transport *transport, const struct basis *basis,
		    const struct basis_tile *tile);

#endif
