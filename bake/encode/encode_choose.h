/* SPDX-License-Identifier: MIT */
/* Chooses the ranks of a fit: the cheapest, by estimates, whose estimated errors under the tried
 * skies are within those asked for. Private to the encoder. */
#ifndef INLAY_BAKE_ENCODE_ENCODE_CHOOSE_H
#define INLAY_BAKE_ENCODE_ENCODE_CHOOSE_H

#include "bake/encode/encode_fit.h"
#include "bake/judge/shade.h"

/* A plan: a pair of ranks and a share of the cut, with the estimates for it. */
struct rank_plan {
	int mono_rank, colour_rank;
	double cost;	  /* bytes of the file plus weighted bytes that a frame reads */
	double excess;	  /* largest error under a sky, as a multiple of the target */
	double cut_share; /* the blocks' share of the cut (basis_format.h) */
};

/* A column of a light whose residual is beyond its limits. */
struct estimate_column {
	int light;
	bool mono;   /* it has one channel */
	float reach; /* largest |residual| */
	float bytes;
};

/* Sums over the columns of a group's lights that have the same number of channels. */
struct estimate_group {
	int columns; /* number of these columns */
	float reach; /* largest |value| that the group's column can have: sum of q_i reach_i */
	float bytes;
};

/* The largest shares of the cut at which a frame reads a column under a sky, and its group's
 * column; 0 where there is none. */
struct estimate_use {
	float own, group;
};

struct choose {
	const struct encode_settings *settings;
	const struct levels *levels;
	const struct shade *shade;
	struct encode_target asked;
	struct estimate_column *column; /* [lights] */
	int columns;
	struct estimate_use *use;	 /* [tried][lights]: by sky and place in column */
	struct estimate_group *group[2]; /* [groups]: sums of colour columns, of mono columns */
	/* These are about the skies that are tried. */
	int order[ENSEMBLE_SKIES_MAX]; /* the sky for which the cut was lowered last is first */
	float *gain;		       /* [tried][3][pixels]: levels per unit of a residual sum */
	float *mono_sky, *colour_sky;  /* [tried][3][RANK_MOST]: the sky's light times a pattern */
};

int choose_create(struct choose *choose, const struct encode_settings *settings,
		  const struct levels *levels);
void choose_free(struct choose *choose); /* zeroed is fine */

/* Finds the fit's patterns and sets its ranks. asked: the errors to keep under the skies that shade
 * tries. -EDOM: weights are not finite. */
int choose_ranks(struct choose *choose, struct low_rank *fit, const struct shade *shade,
		 const struct encode_target *asked);

#endif
