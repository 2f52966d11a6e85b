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

/* R, G, B; the last is 0. The processor adds all four at once. */
typedef float mirror_light __attribute__((vector_size(16)));

struct mirror_map {
	mirror_light *texel[BASIS_MIRROR_LEVELS]; /* [side][side], v by u */
	int least;				  /* the first level that is filled */
	/* Shares of a texel's four parts by solid angle: two of a row, two of the next; of all
	 * levels but the first. */
	mirror_light *share[BASIS_MIRROR_LEVELS];
	double *texel_sr; /* [MIRROR_TEXELS] */
	uint16_t *cell;	  /* [MIRROR_TEXELS]: light of the dome at the texel's middle */
};

/* The basis is not needed afterwards. -ENOMEM; -EINVAL: its lights are no dome's. */
int mirror_map_create(struct mirror_map *map, const struct basis *basis, struct fault *fault);
void mirror_map_free(struct mirror_map *map); /* idempotent; zeroed is fine */

/* Fills all levels with the colours of lights: each cell has one. more: added to all of them. */
void mirror_map_fill(struct mirror_map *map, const double (*radiance)[3], const double more[3]);

/* Fills the levels above map->least. */
void mirror_map_finish(struct mirror_map *map);

/* Looks up the light that a mirror sees. */
mirror_light mirror_map_look(const struct mirror_map *map, const struct basis_mirror *mirror);

/* The light of the dome at the middle of a level's texel. */
static inline int mirror_cell(const struct mirror_map *map, int level, int texel)
{
	const int across = BASIS_MIRROR_SIDE >> level;
	const int x = (2 * (texel % across) + 1) << level >> 1;
	const int y = (2 * (texel / across) + 1) << level >> 1;

	return map->cell[y * BASIS_MIRROR_SIDE + x];
}

/* Brings light to what a texel may hold; what is no number becomes 0. */
static inline float mirror_clamp(float light)
{
	light = light > 0 ? light : 0;
	return light < MIRROR_MOST ? light : MIRROR_MOST;
}

#endif
