/* SPDX-License-Identifier: MIT */
/*
 * The part of a tile that mirrors the sky in the fisheye's picture instead of in cells (struct
 * basis_mirror): what coats of low roughness mirror straight of it.
 *
 * A pixel's samples are divided into a few spots, by the directions that a smooth surface would
 * mirror, and the rough coat's lobe into a few widths: a look-up for each, as wide as both. What a
 * sample has mirrored is shared among the widths by how steep its microfacet was. Spots that are
 * wide beside the sky's cells stay in T: cells have their shape, which a look-up does not.
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
