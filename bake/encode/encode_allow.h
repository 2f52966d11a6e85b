/* SPDX-License-Identifier: MIT */
/* How much of the error asked for each part of a tile may use up: all of it at first, less where
 * the measured errors are too large. Private to the encoder. */
#ifndef INLAY_BAKE_ENCODE_ENCODE_ALLOW_H
#define INLAY_BAKE_ENCODE_ENCODE_ALLOW_H

#include "bake/encode/encode_fit.h"
#include "bake/judge/measure.h"
#include "bake/judge/shade.h"

struct allowance {
	struct encode_target asked; /* errors under skies that ranks are chosen for */
	float short_share;	    /* of columns_find() */
	bool chosen;		    /* the ranks stay as they are */
	int lamps;		    /* how often only the limits of a few lights were narrowed */
};

/* The parts of a tile. */
struct allowed {
	struct part *part;
	const struct fit *fit;
	struct allowance *allowance;
	int count;
	const struct encode_settings *settings;
	const struct shade *shade;
};

/* Sets the allowances of the first attempt. */
void allow_all(const struct allowed *allowed);

/* Lowers them after an attempt (0, 1, ...) whose errors are too large. */
void allow_less(const struct allowed *allowed, const struct measure *measure, int attempt);

#endif
