/* SPDX-License-Identifier: MIT */
/* The allowance of each part of a tile: the errors that its ranks and columns aim at. They are the
 * target at first, and smaller where the measured errors are too large. Private to the encoder. */
#ifndef INLAY_BAKE_ENCODE_ENCODE_ALLOW_H
#define INLAY_BAKE_ENCODE_ENCODE_ALLOW_H

#include "bake/encode/encode_fit.h"
#include "bake/judge/measure.h"
#include "bake/judge/shade.h"

struct allowance {
	struct encode_target asked; /* errors under skies that ranks are chosen for */
	bool chosen;		    /* the ranks are chosen and stay as they are */
};

/* The parts of a tile, with their allowances. */
struct allowed {
	struct part *part;
	const struct low_rank *fit;
	struct allowance *allowance;
	int count;
	const struct encode_settings *settings;
	const struct shade *shade;
};

/* Sets the allowances of the first attempt. */
void allow_target(const struct allowed *allowed);

/* Lowers the allowances after an attempt (0, 1, ...) whose errors are too large. */
void allow_less(const struct allowed *allowed, const struct measure *measure, int attempt);

#endif
