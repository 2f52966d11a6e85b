/* SPDX-License-Identifier: MIT */
/*
 * The ensemble's skies, and a tile's own: suns that leave it dark. There the rest of the sky is all
 * that it is seen by, dim enough for each of its columns to be left out of a frame, and what they
 * come to together is seen best. And those of the watched that showed an error. Private to the
 * encoder.
 */
#ifndef INLAY_BAKE_ENCODE_ENCODE_SHADE_H
#define INLAY_BAKE_ENCODE_ENCODE_SHADE_H

#include "bake/encode/encode_part.h"

struct shade {
	const struct ensemble *common; /* the settings' */
	/* The settings' that are tried, the tile's own, the settings' that are watched; its own
	 * memory. */
	struct ensemble skies;
	int number[ENSEMBLE_SKIES_MAX]; /* of the sky in each place: the same for all tiles */
};

/* -ENOMEM. */
int shade_create(struct shade *shade, const struct encode_settings *settings);
void shade_free(struct shade *shade); /* zeroed is fine */

/* Sets the tile's own from its parts, which are loaded and not yet exposed. */
void shade_set(struct shade *shade, const struct encode_settings *settings,
	       const struct part *parts, int count);

/* A watched sky, by its place, is tried from now on; another takes its place. */
void shade_try(struct shade *shade, int sky);

#endif
