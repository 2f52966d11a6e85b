/* SPDX-License-Identifier: MIT */
/*
 * Two pictures of code values mixed in linear light, by a table:
 *
 *     mixed[a][b] = argmin over codes c of
 *                   |linear(c) - ((1 - share) * linear(a) + share * linear(b))|
 *     mixed[a][a] = a
 *
 * with linear(c) = transfer_curve_decode(curve, c / 255). Of two codes that are equally near, the
 * larger one counts. a and b are code values 0..255 of the same transfer curve.
 */
#ifndef INLAY_HAL_COLOUR_CROSSFADE_H
#define INLAY_HAL_COLOUR_CROSSFADE_H

#include <stdint.h>

#include "hal/colour/transfer.h"

struct crossfade {
	uint8_t mixed[256][256]; /* [code of the first picture][code of the second] */
	/* private: what mixed was made of */
	double linear[256];
	struct transfer_curve curve;
	double share; /* < 0: nothing was made yet */
};

/* Marks the table as not made yet. */
void crossfade_init(struct crossfade *fade);

/* Makes the table for the second picture's share, 0..1. Does nothing when curve and share are those
 * of the call before. */
void crossfade_set(struct crossfade *fade, const struct transfer_curve *curve, double share);

/* out[i] = mixed[first[i]][second[i]]. Several threads may call it at once. */
void crossfade_row(const struct crossfade *fade, const uint8_t *first, const uint8_t *second,
		   int bytes, uint8_t *out);

#endif
