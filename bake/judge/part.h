/* SPDX-License-Identifier: MIT */
/*
 * A part: one set of samples laid out for the encoder, values per unit of X, light by light.
 * Private to the encoder.
 */
#ifndef INLAY_BAKE_JUDGE_PART_H
#define INLAY_BAKE_JUDGE_PART_H

#include <stddef.h>

#include "bake/judge/samples.h"

#define PART_PIXELS (BASIS_TILE * BASIS_TILE)
#define PART_ROWS (3 * PART_PIXELS)
#define RANK_MOST 48 /* patterns of a block, at most */

/* Larger of two numbers. Unlike fmaxf() it does not treat NaN specially and therefore compiles to
 * one instruction. */
static inline float larger(float a, float b)
{
	return a > b ? a : b;
}

/* Smaller of two numbers, in the same way. */
static inline float smaller(float a, float b)
{
	return a < b ? a : b;
}

struct levels; /* expose.h */

struct part {
	enum basis_kind kind;
	int ground;
	int pixels;
	uint16_t pixel[PART_PIXELS];
	int channels; /* of value: 3, or 1 where all three are alike */
	int rows;     /* channels * pixels; row = channel * pixels + place in pixel */
	int direct_channels;
	/* [lights]: share of the error asked for that this part may use up, 1 until the measured
	 * error is too large */
	float *light_share;
	float largest;	   /* maximum of |value| */
	float rounded;	   /* maximum of |direct| + |bounce|: rounding errors are relative to it */
	float *value;	   /* [lights][rows], per unit of X */
	float *direct;	   /* [lights][direct_channels * pixels]; NULL where there is no bounce */
	const float *base; /* [lights][rows]: shown value, errors are added to it: value or u - d */
	const struct levels *levels;
	double column_cut; /* below which columns are left out of a frame; 0: never */
	double group_cut;  /* the same for columns of groups */
	double cut_share;  /* share of the cuts at which columns may be left out as light fades */
	/*
	 * Shown light, for a cell (X is in the slope) and for a sky (X is sky_x):
	 *     cell:  shown = offset + slope * base
	 *     sky:   shown = offset + slope * (sum over lights of X * base)
	 * An error of e in value is shown as slope * e.
	 */
	float cell_offset[3];
	float *cell_slope; /* [3][lights] */
	/* [lights][rows]: smallest (<= 0) and largest residual of a value that keep the error asked
	 * for under its cell alone. */
	float *least_left, *most_left;
	float *tight; /* [lights][rows]: 1 / the smaller magnitude of the two */
	/* Weights of a squared error, by light and by pixel. */
	float *weight; /* [lights] */
	float pixel_weight[PART_PIXELS];
	float *sky_x;	  /* [skies][3][lights] */
	float *sky_value; /* [skies][3 * pixels]: sum over lights of X value */
	/* S of each group under each sky, [skies][3][coarse], and q of each light, [lights]
	 * (hal/basis/basis_groups.h). NULL for D and U, and where columns are never left out. */
	const float *sky_even;
	const double *share;
	float sky_offset[ENSEMBLE_SKIES_MAX][3], sky_slope[ENSEMBLE_SKIES_MAX][3];
	const float *sky_base; /* [skies][3 * pixels]: sum over lights of X base */
	/* Radiance that is shown as 1: per unit radiance of a cell, and under each sky. */
	float *cell_white; /* [lights] */
	double sky_white[ENSEMBLE_SKIES_MAX];
	size_t value_room, direct_room, base_room, sky_room, least_room, most_room, tight_room;
	float *own_base,
		*own_sky; /* memory of base and sky_base, where these are not the values' */
	float *own_even;
	double *own_share, (*beside)[4]; /* [lights]: X of one sky, for basis_group_even() */
};

/* Makes an array at least `count` long; its contents may be lost. -ENOMEM: it stays as it was. */
int part_room_for(float **array, size_t *room, size_t count);

int part_create(struct part *part, const struct encode_settings *settings);
void part_free(struct part *part); /* zeroed is fine */

/* Checks samples and copies them, divided by the factors of X. -EDOM, -ENOMEM. */
int part_load(struct part *part, const struct encode_settings *settings,
	      const struct encode_samples *samples);

/* Joins a pair of D and U: errors of both are added to u - d when shown. -EINVAL: their channels
 * differ; -ENOMEM. */
int part_pair(struct part *difference, struct part *whole, const struct encode_settings *settings);

/* Maximum of 0 and all values; of all magnitudes. */
float part_largest(const float *value, int count);
float part_magnitude(const float *value, int count);

#endif
