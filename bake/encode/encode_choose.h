/* SPDX-License-Identifier: MIT */
/* Chooses the ranks of a fit: those of the least estimated cost whose estimated errors under the
 * skies are within what is asked for. Private to the encoder. */
#ifndef INLAY_BAKE_ENCODE_ENCODE_CHOOSE_H
#define INLAY_BAKE_ENCODE_ENCODE_CHOOSE_H

#include "bake/encode/encode_fit.h"
#include "bake/judge/shade.h"

/* What is expected of a pair of ranks. */
struct estimate {
	int mono_rank, colour_rank;
	double cost;	  /* bytes of the file, plus bytes that a frame reads */
	double excess;	  /* largest error under a sky over that asked for */
	double cut_share; /* of the blocks (basis_format.h) */
};

/* A light whose residual is beyond its limits. */
struct estimate_column {
	int light;
	bool mono;
	float reach;
	float bytes;
};

/* The columns of a group's lights, of one channel or of three. */
struct estimate_group {
	int columns;
	float reach; /* of the group's column */
	float bytes;
};

/* Largest shares of the cut at which a column is read under a sky, and its group's, 0 where there
 * is none. */
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
	struct estimate_use *use;	 /* [tried][lights]: of each column under each sky */
	struct estimate_group *group[2]; /* [groups], of colour and of mono */
	/* These are about the skies that are tried. */
	int order[ENSEMBLE_SKIES_MAX]; /* that for which the cut was lowered last is first */
	float *gain;		       /* [tried][3][pixels]: levels per unit of a residual sum */
	float *mono_sky, *colour_sky;  /* [tried][3][RANK_MOST]: the sky's light times a pattern */
};

int choose_create(struct choose *choose, const struct encode_settings *settings,
		  const struct levels *levels);
void choose_free(struct choose *choose); /* zeroed is fine */

/* Finds the fit's patterns and sets its ranks. asked: the errors to keep under the skies that shade
 * tries. -EDOM: weights are not finite. */
int choose_ranks(struct choose *choose, struct fit *fit, const struct shade *shade,
		 const struct encode_target *asked);

#endif
