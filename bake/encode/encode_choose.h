/* SPDX-License-Identifier: MIT */
/* Chooses the ranks of a fit: those of the least estimated cost whose estimated errors under the
 * skies are within what is asked for. Private to the encoder. */
#ifndef INLAY_BAKE_ENCODE_ENCODE_CHOOSE_H
#define INLAY_BAKE_ENCODE_ENCODE_CHOOSE_H

#include "bake/encode/encode_fit.h"

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

/* A column under a sky. */
struct estimate_use {
	float own[3];	   /* light that the column is weighed by */
	float common[3];   /* light that its group's column puts right for it */
	float share;	   /* largest share of the cut at which the column is read */
	float group_share; /* the same of the group's column; 0: it has none */
	float group_bytes; /* of the group's column, that fall to this one */
};

struct choose {
	const struct encode_settings *settings;
	const struct levels *levels;
	struct estimate_column *column; /* [lights] */
	int columns;
	struct estimate_use *use;	 /* [tried][lights]: of each column under each sky */
	struct estimate_group *group[2]; /* [groups], of colour and of mono */
	float *sky_value;		 /* [tried][3][pixels]: the skies' light times the values */
	float *sky_left;		 /* the same times the residual */
	float *sky_gain;		 /* levels per unit of that */
	float *mono_sky, *colour_sky; /* [tried][3][RANK_MOST]: the skies' light times a pattern */
};

int choose_create(struct choose *choose, const struct encode_settings *settings,
		  const struct levels *levels);
void choose_free(struct choose *choose); /* zeroed is fine */

/* Finds the fit's patterns and sets its ranks. asked: the errors to keep under skies. -ENOMEM,
 * -EDOM. */
int choose_ranks(struct choose *choose, struct fit *fit, const struct encode_target *asked);

#endif
