/* SPDX-License-Identifier: MIT */
/* One camera ray of a tile, and where its light is added. */
#ifndef INLAY_BAKE_TILES_TILE_SAMPLE_H
#define INLAY_BAKE_TILES_TILE_SAMPLE_H

#include "bake/tiles/tile.h"

/* A camera ray and what it meets. */
struct tile_sample {
	int at;		 /* place of the pixel in the tile: y * BASIS_TILE + x */
	uint32_t pixel;	 /* place of the pixel in the picture: y * width + x */
	uint32_t sample; /* number of the sample in its pixel */
	double place[2]; /* the point of the picture that the ray passes, in pixels */
	struct surface surface;
	struct v3 direction;
};

/* Returns the rows to which the current batch adds a pixel's light of a kind. first: it is the
 * pixel's first sample of this kind; the rows are cleared before. */
struct transport_rows tile_rows_for(struct tile *tile, enum tile_kind kind, int at, bool first);

/*
 * Adds a sample that sees a real surface, directly or through glass. direction: the ray's when it
 * meets the surface. weight: the share of the surface's light that arrives, 0..1.
 */
void tile_add_receiver(struct tile *tile, const struct tile_sample *sample,
		       const struct surface *surface, struct v3 direction, float weight);

#endif
