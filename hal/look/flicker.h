/* SPDX-License-Identifier: MIT */
/*
 * Follows lamps that flicker with the mains. A rolling shutter shows them as rows that are brighter
 * and darker. The picture is divided into bands of rows; in each band and channel
 *
 *     gain = median over some points of B / (s M),    M = mean of B / s over the last frames
 *
 * B is the linear light of a point, and s is the factor by which the whole picture should have
 * become brighter (exposure_expected()). The pattern moves from frame to frame, so it cancels in M.
 * Gains of rows are interpolated between the middles of bands.
 *
 * The pattern is flicker, and not noise, people or lamps that move, if adjacent bands agree and
 * successive frames do not. So a pattern that stands still is not found. It does where twice the
 * mains' frequency is a multiple of the frame rate (25 a second at 50 Hz, 30 at 60 Hz).
 */
#ifndef INLAY_HAL_LOOK_FLICKER_H
#define INLAY_HAL_LOOK_FLICKER_H

#include <stdint.h>

#include "hal/colour/transfer.h"
#include "hal/frame/view.h"

struct flicker;

#define FLICKER_ONE 65536 /* gain of a row that is as bright as all others */

/* width and height are the pictures' size. -ENOMEM. */
int flicker_create(struct flicker **flicker, int width, int height,
		   const struct transfer_curve *curve);
void flicker_destroy(struct flicker *flicker); /* NULL is harmless */

/* Looks at the next frame, the upright background. expected holds s > 0 of R, G, B. */
void flicker_look(struct flicker *flicker, const struct picture *background,
		  const float expected[3]);

/* Returns [height] gains of rows, R, G, B, from 1/4 to 4 times FLICKER_ONE, or NULL if nothing
 * flickers. They are valid until the next call of flicker_look(). */
const int32_t (*flicker_rows(const struct flicker *flicker))[3];

#endif
