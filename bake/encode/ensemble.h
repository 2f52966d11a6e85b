/* SPDX-License-Identifier: MIT */
/*
 * The lightings that an encoding is tried under before it is believed.
 *
 * Skies: uniform, overcast (CIE: three times brighter at the zenith), suns of 1, 4 and 16 times the
 * sky's light in a single cell at several heights, coloured lamps, windows, dusk, rooms, random
 * ones. They are the same for every scene and seed; panoramas are not among them, so that those
 * stay unseen until the report. Each tile adds suns that leave it dark (encode_shade.h). Besides,
 * every cell lit alone. Each is exposed like a camera would: white ground, or what is brightest of
 * the object, comes out as 1. Some skies are seen a second time by an object in much less
 * light: there frames leave out most columns, and levels are closest.
 *
 * Most windows and dusks are only watched: blocks that are made without them are measured under
 * them too, and where one shows an error the tile tries it from then on. What a few lights too many
 * left out look like from one side shows under one of so many, and few tiles need any.
 *
 * Errors are in 8-bit sRGB levels of the composite, against the transport before any cut, over the
 * pixels of the blocks: the object's own light, over a background that is the ground's under skies
 * and white under a cell alone.
 */
#ifndef INLAY_BAKE_ENCODE_ENSEMBLE_H
#define INLAY_BAKE_ENCODE_ENSEMBLE_H

#include "hal/basis/basis_format.h"

#define ENSEMBLE_SKIES_MAX 240
#define ENSEMBLE_OWN_MAX 8 /* of them, those that a tile adds */

/* The sine of the least height that a cell counts as having, where its light on level ground sets
 * the exposure: a lamp on the horizon is looked at with something upright in view. */
#define ENSEMBLE_LOWEST 0.05

struct ensemble {
	int lights, skies;
	int tried;	 /* the first of them, which plans are made for; the others are watched */
	float *radiance; /* [skies][3][lights]: L_i */
	/* What the object's brightest spot, or white ground, comes out as. */
	float exposure[ENSEMBLE_SKIES_MAX];
};

/* Sums that can be added up over tiles. */
struct ensemble_error {
	double sky_square[ENSEMBLE_SKIES_MAX]; /* of each sky: sum over pixels and channels */
	double sky_count;
	double sky_max; /* of all */
	double cell_square, cell_count, cell_max;
};

int ensemble_create(struct ensemble *ensemble, const struct basis_light *lights, int count);
void ensemble_free(struct ensemble *ensemble); /* idempotent; zeroed is fine */

/* Of a cell, on level ground: solid angle times the sine of its height, at least
 * ENSEMBLE_LOWEST. */
double ensemble_projected_sr(const struct basis_light *light);

/* A cell that sends size times as much light to level ground as the rest of a blue sky does.
 * radiance: [3][count]. */
void ensemble_sun(const struct basis_light *lights, int count, int cell, double size,
		  float *radiance);

void ensemble_error_add(struct ensemble_error *to, const struct ensemble_error *more);

/* The worst sky's. */
double ensemble_sky_rms(const struct ensemble_error *error);
double ensemble_cell_rms(const struct ensemble_error *error);

#endif
