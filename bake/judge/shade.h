/* SPDX-License-Identifier: MIT */
/*
 * The skies that a tile is tried under: those of the ensemble, suns of the tile's own, and watched
 * skies that have shown an error. A tile's suns stand where they leave it dark. It is then lit by
 * the rest of the sky, which is so dim that a frame leaves out all columns of its cells; here the
 * sum of their errors shows most. Private to the encoder.
 */
#ifndef INLAY_BAKE_JUDGE_SHADE_H
#define INLAY_BAKE_JUDGE_SHADE_H

#include "bake/judge/part.h"

struct shade {
	const struct ensemble *common; /* the settings' ensemble */
	/* The tile's ensemble holds, in this order, the common skies that are tried, the tile's own
	 * suns, and the common skies that are watched. */
	struct ensemble skies;
	int tried[ENSEMBLE_SKIES_MAX]; /* [skies.tried]: indices of the skies that are tried */
};

/* -ENOMEM. */
int shade_create(struct shade *shade, const struct encode_settings *settings);
void shade_free(struct shade *shade); /* zeroed is fine */

/* Begins a tile: its own suns are dark, and only the first skies are tried. */
void shade_begin(struct shade *shade);

/* Sets the tile's own suns from its parts, which must be loaded and not yet exposed. */
void shade_set(struct shade *shade, const struct encode_settings *settings,
	       const struct part *parts, int count);

/* Makes a watched sky, given by its index, a tried one. */
void shade_try(struct shade *shade, int sky);

#endif
