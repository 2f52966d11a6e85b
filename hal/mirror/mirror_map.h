/* SPDX-License-Identifier: MIT */
/*
 * The sky as mirrors show it: a pyramid over the square of hal/optics/sky_square.h, in linear light
 * (struct basis_mirror). Its first level is filled by mirror_eye.h from the fisheye's picture, or
 * here from the lights of the dome, where there is no picture. Floats in a fixed order, without
 * fused operations: the same on every machine.
 */
#ifndef INLAY_HAL_MIRROR_MIRROR_MAP_H
#define INLAY_HAL_MIRROR_MIRROR_MAP_H

#include <stddef.h>
#include <stdint.h>

#include "hal/basis/basis.h"

#define MIRROR_TEXELS (BASIS_MIRROR_SIDE * BASIS_MIRROR_SIDE)
/* The largest light of a texel: far above the sun's in any exposure, and no sum overflows. */
#define MIRROR_MOST 1e9F

/* Texels from one row to the next, of every level. */
#define MIRROR_STRIDE (BASIS_MIRROR_SIDE * 3 / 2)
/* The level that mirror_map_fill() fills: its texels have 1 to 2 degrees; cells are several times
 * as wide. */
#define MIRROR_LIGHTS_LEVEL 2

/* R, G, B; the last is 0. The processor adds all four at once. */
typedef float mirror_light __attribute__((vector_size(16)));
typedef int32_t mirror_integers __attribute__((vector_size(16)));

/* Texels first..end - 1 of a row. */
struct mirror_span {
	uint16_t first, end;
};

struct mirror_map {
	/* [BASIS_MIRROR_SIDE + 1][MIRROR_STRIDE]: level 0, and to the right of it the others, one
	 * below the other; mirror_texels(). The last row is only read with weight 0. */
	mirror_light *texel;
	int least; /* the first level that is filled */
	/* [2 * BASIS_MIRROR_SIDE]: what is filled of each row of all levels; mirror_spans() */
	struct mirror_span *span;
	/* Shares of a texel's four parts by solid angle: two of a row, two of the next; of all
	 * levels but the first. */
	mirror_light *share[BASIS_MIRROR_LEVELS];
	double *texel_sr; /* [MIRROR_TEXELS] */
	uint16_t *cell;	  /* [MIRROR_TEXELS]: light of the dome at the texel's middle */
};

/* The basis is not needed afterwards. -ENOMEM; -EINVAL: its lights are no dome's. */
int mirror_map_create(struct mirror_map *map, const struct basis *basis, struct fault *fault);
void mirror_map_free(struct mirror_map *map); /* idempotent; zeroed is fine */

/* From now on fills only what these poses, which are in memory, look up where `least` is the first
 * level. Before the first call, all is filled. */
void mirror_map_limit(struct mirror_map *map, int least, const struct basis *basis, const int *pose,
		      int poses);

/* Fills the map with the colours of lights: each cell has one. more: added to all of them. */
void mirror_map_fill(struct mirror_map *map, const double (*radiance)[3], const double more[3]);

/* Fills the levels above map->least. */
void mirror_map_finish(struct mirror_map *map);

/* A level's first texel among all. */
static inline int mirror_level_at(int level)
{
	const int above = BASIS_MIRROR_SIDE - (2 * BASIS_MIRROR_SIDE >> level);

	return level ? BASIS_MIRROR_SIDE + above * MIRROR_STRIDE : 0;
}

static inline mirror_light *mirror_texels(const struct mirror_map *map, int level)
{
	return map->texel + mirror_level_at(level);
}

static inline struct mirror_span *mirror_spans(const struct mirror_map *map, int level)
{
	return map->span + 2 * BASIS_MIRROR_SIDE - (2 * BASIS_MIRROR_SIDE >> level);
}

/* The light of the dome at the middle of a level's texel. */
static inline int mirror_cell(const struct mirror_map *map, int level, int x, int y)
{
	return map->cell[((2 * y + 1) << level >> 1) * BASIS_MIRROR_SIDE +
			 ((2 * x + 1) << level >> 1)];
}

/* Brings light to what a texel may hold; what is no number becomes 0. */
static inline mirror_light mirror_clamp(mirror_light light)
{
	const mirror_integers least = (mirror_integers)light & (light > 0);
	const mirror_integers below = (mirror_light)least < MIRROR_MOST;
	const mirror_light most = {MIRROR_MOST, MIRROR_MOST, MIRROR_MOST, MIRROR_MOST};

	return (mirror_light)((least & below) | ((mirror_integers)most & ~below));
}

#endif
