/* SPDX-License-Identifier: MIT */
/*
 * Follows lamps that flicker with the mains, which a rolling shutter shows as rows that are brighter
 * and darker. The picture is divided into bands of rows; in each, and in each channel,
 *
 *     gain = median over some points of B / (s M),    M = mean of B / s over the last frames
 *
 * s is what the whole picture should be brighter by (exposure_expected()). The pattern moves from
 * frame to frame, so M has none of it. Rows between the middles of bands are interpolated.
 *
 * It is flicker, and not noise, people or lamps that move, where it is alike in adjacent bands and
 * not alike in successive frames. So a pattern that stands still is not found: where the camera's
 * frames a second divide twice the mains' frequency (25 at 50 Hz, 30 at 60 Hz).
 */
#ifndef INLAY_HAL_LOOK_FLICKER_H
#define INLAY_HAL_LOOK_FLICKER_H

#include <stdint.h>

#include "hal/colour/transfer.h"
#include "hal/frame/view.h"

struct flicker;

#define FLICKER_ONE 65536 /* gain of a row that is as bright as all others */

/* width, height: of the pictures. -ENOMEM. */
int flicker_create(struct flicker **flicker, int width, int height,
		   const struct transfer_curve *curve);
void flicker_destroy(struct flicker *flicker); /* NULL is harmless */

/* Looks at the next frame, the upright background. expected: s, R, G, B, > 0. */
void flicker_look(struct flicker *flicker, const struct picture *background,
		  const float expected[3]);

/* What each row's light is multiplied by, [height] of R, G, B, 1/4 to 4 times FLICKER_ONE; NULL:
 * nothing flickers. Valid until the next look. */
const int32_t (*flicker_rows(const struct flicker *flicker))[3];

#endif
