/* SPDX-License-Identifier: MIT */
/*
 * Scales a picture to another size by a tent filter: as wide as a source pixel where it enlarges
 * (bilinear), as a destination pixel where it shrinks, so that small things neither flicker nor
 * vanish. Weights are made once for a pair of sizes; equal sizes are an exact copy. (libyuv's
 * scaler allocates rows at every call, which the frame path must not.)
 */
#ifndef INLAY_APP_VIEW_SCALER_H
#define INLAY_APP_VIEW_SCALER_H

#include <stddef.h>
#include <stdint.h>

#include "hal/base/pool.h"
#include "hal/frame/view.h"

struct scaler_axis {
	int from, to;
	int taps;	  /* source pixels under the filter of a destination pixel */
	int *first;	  /* [to]: its first source pixel; first + taps <= from */
	uint16_t *weight; /* [to][taps]: Q14, summing to 1 */
};

struct scaler {
	struct scaler_axis across, down;
	int workers;
	size_t scratch_bytes;
	uint8_t *scratch; /* [workers][scratch_bytes]: rows scaled across */
};

/* Prepares for these sizes, all at least 1; does nothing if it is prepared for them. 0 or -ENOMEM.
 * A zeroed scaler is valid. */
int scaler_fit(struct scaler *scaler, int from_width, int from_height, int to_width, int to_height,
	       const struct pool *pool);

/* Writes columns left..right-1 of the result, BGRX, each pixel once. out: where column left of the
 * first row goes. from has the size given to scaler_fit(); 0 <= left <= right <= to_width. */
void scaler_run(struct scaler *scaler, struct pool *pool, const struct picture *from, int left,
		int right, uint8_t *out, size_t out_stride);

void scaler_free(struct scaler *scaler); /* idempotent */

/* Copies an upright picture, pixel by pixel. */
void picture_copy(const struct picture *from, uint8_t *out, size_t out_stride);

#endif
