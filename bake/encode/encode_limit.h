/* SPDX-License-Identifier: MIT */
/* Limits of residuals, and weights of lights and pixels. A residual within its limits keeps the
 * error asked for while its light shines alone. Private to the encoder. */
#ifndef INLAY_BAKE_ENCODE_ENCODE_LIMIT_H
#define INLAY_BAKE_ENCODE_ENCODE_LIMIT_H

#include "bake/judge/expose.h"

/* Sets the limits and weights of a part. Call it after parts_expose(), and whenever its light_share
 * has changed. */
void part_limit(struct part *part, const struct encode_settings *settings,
		const struct levels *levels);

/* Tells whether a light's residual left [rows] is within its limits. */
bool part_cell_holds(const struct part *part, int light, const float *left);

#endif
