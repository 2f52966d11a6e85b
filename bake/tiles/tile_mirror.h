/* SPDX-License-Identifier: MIT */
/*
 * The part of a tile that mirrors the sky in the fisheye's picture instead of in cells (struct
 * basis_mirror): what coats of low roughness mirror straight of it.
 *
 * A pixel's mirrored directions are gathered, and divided into a few spots about as wide as texels
 * of the pyramid. Directions outside of all spots, and spots that are wide beside the sky's cells,
 * go back to T: cells have their shape, which spots do not.
 */
#ifndef INLAY_BAKE_TILES_TILE_MIRROR_H
#define INLAY_BAKE_TILES_TILE_MIRROR_H

#include "bake/tiles/tile_sample.h"

/* Makes tile->mirror. -ENOMEM. */
int tile_mirror_create(struct tile *tile);
void tile_mirror_clear(struct tile *tile);

/* Adds a sample that met a coat of low roughness. Returns false, and adds nothing, where it has met
 * something else. */
bool tile_mirror_add(struct tile *tile, const struct tile_sample *sample,
		     const struct transport_rows *rows);

/* Fills tile->result.mirror, and returns the rest to the rows of TILE_OBJECT, which are still
 * sums. */
void tile_mirror_finish(struct tile *tile);

#endif
