/* SPDX-License-Identifier: MIT */
/*
 * The ensemble of lightings under which the error of an encoding is measured.
 *
 * Skies: uniform, overcast (CIE: three times brighter at the zenith), suns of 1, 4 and 16 times the
 * sky's light in a single cell at several heights, coloured lamps, windows, dusks, rooms, and
 * random ones. They are the same for every scene and seed. Panoramas are not among them, so that
 * the report tests with lightings that the encoder has not met. Each tile adds suns that leave it
 * dark (shade.h). Besides the skies, every cell is lit alone. The exposure makes white ground, or
 * the brightest spot of the object, 1. Some skies occur again at an eighth of it: there frames
 * leave out most columns, and 8-bit levels are closest together.
 *
 * The first skies are tried: ranks are chosen so that their errors hold. The others are watched:
 * the finished blocks are measured under them too, and if the error of one is too large, the tile
 * tries it from then on. Watched are most windows and dusks, as each of them matters to few tiles,
 * and strong suns in many other cells over a white background, where the deepest shadow shows the
 * errors of the dim rest of the sky.
 *
 * Errors are in 8-bit sRGB levels of the composite, against the exact transport, over the pixels of
 * the blocks. The composite is the object's own light over a background: the lit ground under
 * skies, white under a single cell.
 */
#ifndef INLAY_BAKE_JUDGE_ENSEMBLE_H
#define INLAY_BAKE_JUDGE_ENSEMBLE_H

#include <stdbool.h>

#include "hal/basis/basis_format.h"

#define ENSEMBLE_SKIES_MAX 288
#define ENSEMBLE_OWN_MAX 8 /* a tile adds at most this many of them */

/* The exposure for a cell's light on level ground takes at least this sine of its height: with a
 * lamp on the horizon a camera has something upright in view. */
#define ENSEMBLE_LOWEST 0.05

#define ENSEMBLE_SUNS 12

/* One of the skies of ensemble_sun(). */
struct ensemble_sun {
	int cell;
	double radiance; /* the cell's, added to the sky's own */
	double white;	 /* radiance of white level ground, in its brightest channel */
};

struct ensemble {
	int lights, skies;
	int tried;	 /* ranks are chosen for the first `tried` skies; the others are watched */
	float *radiance; /* [skies][3][lights]: L_i */
	/* Linear light that the picture shows of the object's brightest spot, or of white
	 * ground. */
	float exposure[ENSEMBLE_SKIES_MAX];
	/* True if nearly all light comes from one cell. The background is then white, and errors
	 * count as those of a cell alone. */
	bool strong[ENSEMBLE_SKIES_MAX];
	struct ensemble_sun sun[ENSEMBLE_SUNS]; /* among the skies */
};

/* Errors in levels, as sums that can be added up over tiles. */
struct ensemble_error {
	double sky_square[ENSEMBLE_SKIES_MAX]; /* sum of squares over pixels and channels */
	double sky_count;
	double sky_max; /* over all skies */
	double cell_square, cell_count, cell_max;
};

int ensemble_create(struct ensemble *ensemble, const struct basis_light *lights, int count);
void ensemble_free(struct ensemble *ensemble); /* idempotent; zeroed is fine */

/* Returns a cell's irradiance on level ground per radiance: its solid angle times the sine of its
 * height, which counts as at least ENSEMBLE_LOWEST. */
double ensemble_projected_sr(const struct basis_light *light);

/* Radiance R, G, B of the sky around a sun. */
extern const double ensemble_blue[3];

/* Sets radiance [3][count] to a sky of ensemble_blue with a sun in one cell, which sends `size`
 * times as much light to level ground as the rest of the sky. */
void ensemble_sun(const struct basis_light *lights, int count, int cell, double size,
		  float *radiance);

void ensemble_error_add(struct ensemble_error *to, const struct ensemble_error *more);

/* Returns the RMS error of the worst sky. */
double ensemble_sky_rms(const struct ensemble_error *error);
/* Returns the RMS error over all cells. */
double ensemble_cell_rms(const struct ensemble_error *error);

#endif
