/* SPDX-License-Identifier: MIT */
/*
 * The ensemble of lightings under which the error of an encoding is measured.
 *
 * Skies: uniform, overcast (CIE: three times brighter at the zenith), suns of 1, 4 and 16 times the
 * sky's light in a single cell at several heights, coloured lamps, windows, dusk, rooms, and random
 * ones. They are the same for every scene and seed. Panoramas are not among them, so that the
 * report can test with panoramas that the encoder has not seen. Each tile adds suns that leave it
 * dark (shade.h). Besides the skies, every cell is lit alone. Exposure is that of a camera:
 * white ground, or the brightest spot of the object, becomes 1. Some skies occur again with much
 * less light on the object: there frames leave out most columns, and 8-bit levels are closest
 * together.
 *
 * Most windows and dusks are only watched: ranks are chosen without them, but blocks are
 * measured under them too, and where one shows too large an error the tile tries it from then on.
 * Columns that should not be left out show under few of these skies, and few tiles need any of
 * them. So are suns in many other cells, over a white background, where what is left out of the rest
 * of the sky shows most: in the deepest shadow.
 *
 * Errors are in 8-bit sRGB levels of the composite, against the transport before any cut, over the
 * pixels of the blocks: the object's own light over a background, which is the ground's under skies
 * and white under a single cell.
 */
#ifndef INLAY_BAKE_JUDGE_ENSEMBLE_H
#define INLAY_BAKE_JUDGE_ENSEMBLE_H

#include <stdbool.h>

#include "hal/basis/basis_format.h"

#define ENSEMBLE_SKIES_MAX 288
#define ENSEMBLE_OWN_MAX 8 /* how many of these a tile adds */

/* Least sine of a cell's height, where its light on level ground sets the exposure: with a lamp on
 * the horizon a camera has something upright in view. */
#define ENSEMBLE_LOWEST 0.05

#define ENSEMBLE_SUNS 12

/* One of the skies of ensemble_sun(). */
struct ensemble_sun {
	int cell;
	double radiance; /* of the cell, beside the sky's own */
	double white;	 /* radiance of white level ground, in its brightest channel */
};

struct ensemble {
	int lights, skies;
	int tried;	 /* ranks are chosen for the first `tried` skies; the others are watched */
	float *radiance; /* [skies][3][lights]: L_i */
	/* Linear light of the object's brightest spot, or of white ground, in the picture. */
	float exposure[ENSEMBLE_SKIES_MAX];
	/* Nearly all light is from one cell: the background is white, as under a cell alone, and
	 * errors count as those of a cell alone. */
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

/* Solid angle of a cell times the sine of its height, at least ENSEMBLE_LOWEST: its irradiance on
 * level ground per radiance. */
double ensemble_projected_sr(const struct basis_light *light);

/* Blue of the sky around a sun, by channel. */
extern const double ensemble_blue[3];

/* Sets radiance [3][count] to a sky of ensemble_blue with a sun in one cell, which sends `size` times as much
 * light to level ground as the rest of the sky. */
void ensemble_sun(const struct basis_light *lights, int count, int cell, double size,
		  float *radiance);

void ensemble_error_add(struct ensemble_error *to, const struct ensemble_error *more);

/* RMS error of the worst sky. */
double ensemble_sky_rms(const struct ensemble_error *error);
/* RMS error over all cells. */
double ensemble_cell_rms(const struct ensemble_error *error);

#endif
