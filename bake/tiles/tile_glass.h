/* SPDX-License-Identifier: MIT */
/* The part of a tile that is seen through the object's glass. */
#ifndef INLAY_BAKE_TILES_TILE_GLASS_H
#define INLAY_BAKE_TILES_TILE_GLASS_H

#include "bake/tiles/tile_sample.h"

/* Adds a sample that met glass of the object. Light that passes through, straight or refracted,
 * counts as background if it comes from a place that the picture shows. All other light is the
 * object's and goes to rows. */
void tile_glass_add(struct tile *tile, const struct tile_sample *sample,
		    const struct transport_rows *rows);

/* Fills tile->result.glass and tile->result.opaque. tile->result.coverage must be known. */
void tile_glass_finish(struct tile *tile);

#endif
