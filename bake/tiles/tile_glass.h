/* SPDX-License-Identifier: MIT */
/* What a tile shows through the object's glass. */
#ifndef INLAY_BAKE_TILES_TILE_GLASS_H
#define INLAY_BAKE_TILES_TILE_GLASS_H

#include "bake/tiles/tile_sample.h"

/* A sample that met glass of the object: what passes straight or bent to a place that the picture
 * shows counts as background, all else is light of the object. rows: the object's. */
void tile_glass_add(struct tile *tile, const struct tile_sample *sample,
		    const struct transport_rows *rows);

/* Fills glass and opaque, after coverage. */
void tile_glass_finish(struct tile *tile);

#endif
