/*
 * The lightings that an encoding is tried under before it is believed.
 *
 * Skies: uniform, overcast (CIE: three times brighter at the zenith), suns of 1 and 4 times the
 * sky's light in a single cell at several heights, coloured lamps, random ones. Besides, every cell
 * lit alone. Each is exposed like a camera would: white ground, or what is brightest of the object,
 * comes out as 1. They are the same for every scene and seed; panoramas are not among them, so that
 * those stay unseen until the report.
 *
 * Errors are in 8-bit sRGB levels of the composite, against the transport before any cut, over the
 * pixels of the blocks: the object's own light, over a background that is the ground's.
 */
#ifndef INLAY_BAKE_ENSEMBLE_H
#define INLAY_BAKE_ENSEMBLE_H

#include "hal/basis/basis_format.h"

struct ensemble {
	int lights, skies;
	float *radiance; /* [skies][3][lights]: L_i */
};

/* Sums that can be added up over tiles. */
struct ensemble_error {
	double sky_square[64]; /* [skies]: sum over pixels and channels */
	double sky_count;
	double sky_max; /* of all */
	double cell_square, cell_count, cell_max;
};

int ensemble_create(struct ensemble *ensemble, const struct basis_light *lights, int count);
void ensemble_free(struct ensemble *ensemble); /* idempotent; zeroed is fine */

void ensemble_error_add(struct ensemble_error *to, const struct ensemble_error *more);

/* The worst sky's. */
double ensemble_sky_rms(const struct ensemble_error *error);
double ensemble_cell_rms(const struct ensemble_error *error);

#endif
