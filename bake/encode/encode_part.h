/* SPDX-License-Identifier: MIT */
/*
 * A set of samples laid out for the encoder: values per unit of X, light by light. Private to the
 * encoder.
 */
#ifndef INLAY_BAKE_ENCODE_ENCODE_PART_H
#define INLAY_BAKE_ENCODE_ENCODE_PART_H

#include <stddef.h>

#include "bake/encode/encode.h"

#define PART_PIXELS (BASIS_TILE * BASIS_TILE)
#define PART_ROWS (3 * PART_PIXELS)

/* Of numbers. fmaxf() minds those that are none, too, for which it has to be called. */
static inline float larger(float a, float b)
{
	return a > b ? a : b;
}

static inline float smaller(float a, float b)
{
	return a < b ? a : b;
}

struct levels; /* encode_expose.h */

struct part {
	enum basis_kind kind;
	int ground;
	int pixels;
	uint16_t pixel[PART_PIXELS];
	bool keep[PART_PIXELS]; /* false: changes nothing worth a place in the blocks */
	int kept;
	int channels; /* of value: 3, or 1 where all three are alike */
	int rows;     /* channels * pixels; row = channel * pixels + place in pixel */
	int direct_channels;
	/* Of the error asked for, what this part may use up: 1 until the measured one is too
	 * large. */
	float sky_share[PART_PIXELS], cell_share[PART_PIXELS];
	float fine;	   /* of the latter, what a light by itself may: 1 until no plan holds */
	float largest;	   /* of all |value| */
	float rounded;	   /* of all |direct| + |bounce|: what roundings are a share of */
	float *value;	   /* [lights][rows], per unit of X */
	float *direct;	   /* [lights][direct_channels * pixels]; NULL where there is no bounce */
	const float *base; /* [lights][rows]: what an error in value is seen on: value itself, or
			      u - d */
	const struct levels *levels;
	double column_cut; /* below which columns are left out of a frame; 0: never */
	double group_cut;  /* the same of groups' columns */
	/*
	 * Shown light is offset + slope * base * (light's X); an error of e in value is seen as
	 * slope * e. Cells: X is in slope. Skies: X is sky_x.
	 */
	float cell_offset[3];
	float *cell_slope; /* [3][lights] */
	/* [lights][rows]: what may be left of a value, from least to most, under its cell alone. */
	float *least_left, *most_left;
	/* How much a squared error counts: of a light's values, and of a pixel's. */
	float *weight; /* [lights] */
	float pixel_weight[PART_PIXELS];
	float *sky_x; /* [skies][3][lights] */
	/* Of T and V where columns may be left out, else NULL: what the lights of a group have in
	 * common under each sky, [skies][3][coarse], and each light's share of its group, [lights]
	 * (hal/basis/basis_groups.h). */
	const float *sky_even;
	const double *share;
	float sky_offset[ENSEMBLE_SKIES_MAX][3], sky_slope[ENSEMBLE_SKIES_MAX][3];
	float *sky_base; /* [skies][3 * pixels]: sum of X base */
	/* The radiance that comes out as 1, where L is 1 in the cell, and as the sky has it. */
	float *cell_white; /* [lights] */
	double sky_white[ENSEMBLE_SKIES_MAX];
	size_t value_room, direct_room, base_room, least_room, most_room;
	float *own_base; /* where base is not value */
	float *own_even;
	double *own_share, (*beside)[4]; /* [lights]; a sky's X, as groups are asked for it */
};

/* Makes an array at least so long; what it held may be lost. -ENOMEM: it stays as it was. */
int part_room_for(float **array, size_t *room, size_t count);

int part_create(struct part *part, const struct encode_settings *settings);
void part_free(struct part *part); /* zeroed is fine */

/* Takes the samples in: checks them, divides by X's factors. -EDOM, -ENOMEM. */
int part_load(struct part *part, const struct encode_settings *settings,
	      const struct encode_samples *samples);

/* For a pair: errors of both are seen on u - d. */
int part_pair(struct part *difference, struct part *whole, int lights);

#endif
