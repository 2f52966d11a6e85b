/* SPDX-License-Identifier: MIT */
/*
 * The skies that a tile is tried under: those of the ensemble, suns of its own, and watched skies
 * that have shown an error. The suns stand where they leave the tile dark. Then it is lit by the
 * rest of the sky alone, which is so dim that each of its columns is left out of a frame; the sum
 * of all these is seen best there. Private to the encoder.
 */
#ifndef INLAY_BAKE_JUDGE_SHADE_H
#define INLAY_BAKE_JUDGE_SHADE_H

#include "bake/judge/part.h"

struct shade {
	const struct ensemble *common; /* of the settings */
	/* Own copy, in this order: skies of the settings that are tried, the tile's own suns, skies
	 * of the settings that are watched. */
	struct ensemble skies;
	int tried[ENSEMBLE_SKIES_MAX]; /* [skies.tried]: places of the skies that are tried */
};

/* -ENOMEM. */
int shade_create(struct shade *shade, const struct encode_settings *settings);
void shade_free(struct shade *shade); /* zeroed is fine */

/* Begins a tile: its own suns are dark, and those of the settings' skies are tried that were at
 * first. */
void shade_begin(struct shade *shade);

/* Sets the tile's own suns from its parts, which must be loaded and not yet exposed. */
void shade_set(struct shade *shade, const struct encode_settings *settings,
	       const struct part *parts, int count);

/* Makes a watched sky, given by its place, a tried one. */
void shade_try(struct shade *shade, int sky);

#endif
