/* SPDX-License-Identifier: MIT */
/* The limits within which each residual keeps the error asked for under its light alone, and what
 * errors of lights and pixels weigh. Private to the encoder. */
#ifndef INLAY_BAKE_ENCODE_ENCODE_LIMIT_H
#define INLAY_BAKE_ENCODE_ENCODE_LIMIT_H

#include "bake/judge/expose.h"

/* Sets the limits of residuals, and the weights of lights and pixels: after parts_expose(), and
 * again when shares have changed. */
void part_limit(struct part *part, const struct encode_settings *settings,
		const struct levels *levels);

/* Tells whether a light's residual left [rows] keeps all pixels within the error asked for under
 * this cell alone. */
bool part_cell_holds(const struct part *part, int light, const float *left);

#endif
