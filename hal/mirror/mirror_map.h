/* SPDX-License-Identifier: MIT */
/*
 * The sky as mirrors show it: a pyramid over the square of hal/optics/sky_square.h, in linear light
 * (struct basis_mirror). Its first level is filled by mirror_eye.h from the fisheye's picture, or
 * here from the lights of the dome, where there is no picture. Integers alone: the same on every
 * machine.
 */
#ifndef INLAY_HAL_MIRROR_MIRROR_MAP_H
#define INLAY_HAL_MIRROR_MIRROR_MAP_H

#include <stddef.h>
#include <stdint.h>

#include "hal/basis/basis.h"

#define MIRROR_TEXELS (BASIS_MIRROR_SIDE * BASIS_MIRROR_SIDE)
/* A texel's 1.0 is 2^14: its rounding is a tenth of an 8-bit level in the dark, and its largest
 * value, 262,143, above what the sun is in a texel in all but extreme exposures. */
#define MIRROR_ONE_BITS 14
/* Fraction bits of a look-up: a texel's, 2 * 8 of its place between texels, and 8 of the level. */
#define MIRROR_LOOK_BITS (MIRROR_ONE_BITS + 24)

struct mirror_texel {
	uint32_t light[4]; /* R, G, B; 0 */
};

struct mirror_map {
	struct mirror_texel *texel[BASIS_MIRROR_LEVELS]; /* [side][side], v by u */
	/* Shares of a texel's four parts by solid angle, 65536 = 1: two of a row, two of the next;
	 * of all levels but the first. */
	uint16_t (*share[BASIS_MIRROR_LEVELS])[4];
	double *texel_sr;   /* [MIRROR_TEXELS] */
	uint16_t *cell;	    /* [MIRROR_TEXELS]: light of the dome at the texel's middle */
};

/* The basis is not needed afterwards. -ENOMEM; -EINVAL: its lights are no dome's. */
int mirror_map_create(struct mirror_map *map, const struct basis *basis, struct fault *fault);
void mirror_map_free(struct mirror_map *map); /* idempotent; zeroed is fine */

/* Fills all levels with the colours of lights: each cell has one. more: added to all of them. */
void mirror_map_fill(struct mirror_map *map, const double (*radiance)[3], const double more[3]);

/* Fills the levels above the first. */
void mirror_map_finish(struct mirror_map *map);

/* Looks up the light that a mirror sees; MIRROR_LOOK_BITS fraction bits, below 2^56. */
void mirror_map_look(const struct mirror_map *map, const struct basis_mirror *mirror,
		     uint64_t light[3]);

/* The value of a texel for this linear light. */
uint32_t mirror_texel_of(double light);

#endif
