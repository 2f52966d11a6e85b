/* SPDX-License-Identifier: MIT */
/*
 * A part is one set of samples laid out for the encoder: values per unit of X, light by light.
 * Private to the encoder.
 */
#ifndef INLAY_BAKE_JUDGE_PART_H
#define INLAY_BAKE_JUDGE_PART_H

#include <stddef.h>

#include "bake/judge/samples.h"

#define PART_PIXELS (BASIS_TILE * BASIS_TILE)
#define PART_ROWS (3 * PART_PIXELS)
#define RANK_MOST 48 /* a block has at most this many patterns */

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

/* Under a cell alone the picture shows offset + slope * base; X is in the slope. An error e of
 * value shows as slope * e. */
struct part_cell {
	float offset[3];
	float *slope; /* [3][lights] */
	float *white; /* [lights]: radiance that is shown as 1, at a cell's radiance of 1 */
};

/* Under a sky the picture shows offset + slope * (sum over lights of X base). */
struct part_sky {
	float *x;	   /* X of each light, [skies][3][lights] */
	float *value;	   /* [skies][3 * pixels]: sum over lights of X value */
	const float *base; /* [skies][3 * pixels]: sum over lights of X base */
	float offset[ENSEMBLE_SKIES_MAX][3], slope[ENSEMBLE_SKIES_MAX][3];
	double white[ENSEMBLE_SKIES_MAX]; /* radiance that is shown as 1 */
	/* S of each group under each sky, [skies][3][coarse], and q of each light, [lights]
	 * (hal/basis/basis_groups.h). NULL for D and U, and where columns are never left out. */
	const float *even;
	const double *share;
	float *own_even;   /* memory of even */
	double *own_share; /* memory of share */
	float *own_base;   /* memory of base, for a U; its D borrows it */
	size_t room;
	double (*light)[4]; /* [lights]: X of one sky, for basis_group_even() */
};

/* Errors that residuals may have, and what they weigh; set by part_limit() of the encoder. */
struct part_limit {
	/* [lights]: the part's residual may use up this share of the error asked for; it is 1 until
	 * the measured error is too large. */
	float *light_share;
	/* [lights][rows]: the limits of a residual, least <= 0 <= most, within which the error
	 * under its cell alone is at most that asked for. */
	float *least, *most;
	float *tight; /* [lights][rows]: 1 / min(most, -least) */
	/* Weights of a squared error, by light and by pixel (W and h of bake/encode/README.md). */
	float *weight; /* [lights] */
	float pixel_weight[PART_PIXELS];
	double column_cut; /* frames leave out columns below this; 0: none */
	double group_cut;  /* the same for columns of groups */
	double cut_share;  /* largest share of the cuts that a block may have */
	size_t least_room, most_room, tight_room;
};

struct part {
	enum basis_kind kind;
	int ground;
	int pixels;
	uint16_t pixel[PART_PIXELS];
	int channels; /* channels of value: 3, or 1 if all three are alike */
	int rows;     /* channels * pixels; row = channel * pixels + place in pixel */
	int direct_channels;
	float largest; /* maximum of |value| */
	float rounded; /* maximum of |direct| + |bounce|: rounding errors are relative to it */
	float *value;  /* [lights][rows], per unit of X */
	float *direct; /* [lights][direct_channels * pixels]; NULL where there is no bounce */
	const float
		*base;	 /* [lights][rows]: the value shown, to which errors add: value or u - d */
	float *own_base; /* memory of base, for a U; its D borrows it */
	size_t value_room, direct_room, base_room;
	struct part_cell cell;
	struct part_sky sky;
	struct part_limit limit;
};

/* Makes an array at least `count` long; its contents are undefined then. -ENOMEM: it stays as it
 * was. */
int part_room_for(float **array, size_t *room, size_t count);

int part_create(struct part *part, const struct encode_settings *settings);
void part_free(struct part *part); /* zeroed is fine */

/* Checks samples and copies them, divided by the factors of X. -EDOM, -ENOMEM. */
int part_load(struct part *part, const struct encode_settings *settings,
	      const struct encode_samples *samples);

/* Joins a pair of D and U: both show u - d, to which errors of either add. -EINVAL: their channels
 * differ; -ENOMEM. */
int part_pair(struct part *difference, struct part *whole, const struct encode_settings *settings);

/* Returns the maximum of 0 and all values. */
float part_largest(const float *value, int count);
/* Returns the maximum of all magnitudes. */
float part_magnitude(const float *value, int count);

#endif
