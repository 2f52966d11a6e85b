/* SPDX-License-Identifier: MIT */
/*
 * How finely a sky has to be divided: where its light is not spread evenly over the cells of a
 * dome, as that of a sun or of small lamps.
 *
 * A dome spreads the light of each cell evenly. How far that moves light is estimated as
 *
 *     m = 1/2 sum |e - mean e| * spacing / E     rad
 *
 * with the irradiance e of small pieces of a cell, the whole sky's E, and the distance between the
 * dome's nodes. Light changes: m of a cell is the largest one at any moment, so that a sun that
 * passes or a lamp that shines for an hour counts as much as one that always shines.
 */
#ifndef INLAY_BAKE_SKY_SKY_NEED_H
#define INLAY_BAKE_SKY_SKY_NEED_H

#include "hal/optics/dome.h"
#include "hal/optics/panorama.h"

#define SKY_LEVELS 7		    /* frequencies F, 2 F, 4 F ... up to DOME_FREQUENCY_MAX */
#define SKY_SPACING_RAD 1.107148718 /* between two nodes of the icosahedron: atan(2) */

struct sky_need {
	struct dome
		level[SKY_LEVELS]; /* the base dome first; the cells of the last are the pieces */
	int levels;
	int *cell[SKY_LEVELS];	     /* [piece]: the cell of that level in which it lies */
	double *even;		     /* [piece]: irradiance by a sky of radiance 1 */
	double *share;		     /* [piece]: largest e / E of all moments */
	double (*moved)[SKY_LEVELS]; /* [cell]: m if the cell is divided as in a level */
	/* Scratch of a moment: */
	double *irradiance; /* [piece]: for the caller to fill */
	double (*now)[SKY_LEVELS], (*sum)[2];
};

/* Begins with no moment; the base dome is divided by angles. 0; -EINVAL: frequency; -ENOMEM. */
int sky_need_create(struct sky_need *need, int frequency, struct fault *fault);
void sky_need_free(struct sky_need *need); /* idempotent; zeroed is fine */

/* The pieces: a piece of radiance L has the irradiance L * even[piece]. */
const struct dome *sky_need_pieces(const struct sky_need *need);

/* Adds the moment in irradiance[pieces], e >= 0. least: an E below it counts as this one, so that
 * the noise of a picture in the dark needs nothing. */
void sky_need_add(struct sky_need *need, double least);

/* Adds a panorama as a moment: the mean of its channels. */
void sky_need_add_panorama(struct sky_need *need, const struct panorama *panorama);

#endif
