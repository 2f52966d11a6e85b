/* SPDX-License-Identifier: MIT */
/* Looks up what a mirror sees (struct basis_mirror) in a map. */
#ifndef INLAY_HAL_MIRROR_MIRROR_LOOK_H
#define INLAY_HAL_MIRROR_MIRROR_LOOK_H

#include <string.h>

#include "hal/mirror/mirror_map.h"

/* The four texels around a place; the second ones are of the next row, MIRROR_STRIDE further. */
struct mirror_place {
	int level, x, y; /* the upper left one */
	int right, down; /* 65536 = 1: shares of the right ones, of the lower ones */
};

/* A look-up, ready to be read. */
struct mirror_look {
	uint32_t at[2];	    /* the upper left of four texels, in two levels: bytes of the map */
	uint16_t weight[8]; /* of these texels, row by row; their sum is MIRROR_LOOK_ONE */
	uint16_t throughput[3];
	uint16_t pixel; /* for the caller */
};

#define MIRROR_LOOK_ONE 65535

/* Finds the places in the two levels that a mirror shows where `least` is the first. Returns the
 * share of the second, BASIS_MIRROR_STEP = 1; if it is 0, both are the same. */
int mirror_look_places(const struct basis_mirror *mirror, int least, struct mirror_place place[2]);

/* Prepares a look-up in maps whose first level is `least`. Sets all but the pixel. */
void mirror_look_aim(struct mirror_look *look, const struct basis_mirror *mirror, int least);

typedef uint16_t mirror_codes __attribute__((vector_size(16)));

/* The first four codes as floats. */
static inline mirror_light mirror_floats(mirror_codes c)
{
	return __builtin_convertvector(
		(mirror_integers)__builtin_shufflevector(c, c ^ c, 0, 8, 1, 9, 2, 10, 3, 11),
		mirror_light);
}

static inline mirror_light mirror_weigh(const mirror_light *texel, mirror_light w)
{
	const mirror_light *below = texel + MIRROR_STRIDE;

	return (texel[0] * __builtin_shufflevector(w, w, 0, 0, 0, 0) +
		texel[1] * __builtin_shufflevector(w, w, 1, 1, 1, 1)) +
	       (below[0] * __builtin_shufflevector(w, w, 2, 2, 2, 2) +
		below[1] * __builtin_shufflevector(w, w, 3, 3, 3, 3));
}

static inline const mirror_light *mirror_look_at(const struct mirror_map *map, uint32_t bytes)
{
	return (const mirror_light *)((const char *)map->texel + bytes);
}

/* Fetches what a look-up will read in its finer level: maps are larger than the nearest caches. */
static inline void mirror_look_fetch(const struct mirror_map *map, const struct mirror_look *look)
{
	const mirror_light *texel = mirror_look_at(map, look->at[0]);

	__builtin_prefetch(texel);
	__builtin_prefetch(texel + MIRROR_STRIDE);
}

/* Returns throughput times light, 65535 * MIRROR_LOOK_ONE = 1. The last is of no use. */
static inline mirror_light mirror_look_read(const struct mirror_map *map,
					    const struct mirror_look *look)
{
	mirror_codes upper, lower;

	/* Loads of eight codes each: of four, the compiler makes many. */
	memcpy(&upper, look->weight, sizeof(upper));
	memcpy(&lower, (const char *)look + offsetof(struct mirror_look, weight[4]), sizeof(lower));
	return (mirror_weigh(mirror_look_at(map, look->at[0]), mirror_floats(upper)) +
		mirror_weigh(mirror_look_at(map, look->at[1]), mirror_floats(lower))) *
	       mirror_floats(__builtin_shufflevector(lower, lower, 4, 5, 6, 7, 4, 5, 6, 7));
}

#endif
