/* SPDX-License-Identifier: MIT */
/* Peaks: the largest radiance of any pixel of the object (BASIS_CHUNK_PEAK), [lights + 1][3]: per
 * unit of each light, and last under all of them. */
#ifndef INLAY_BAKE_TILES_PEAKS_H
#define INLAY_BAKE_TILES_PEAKS_H

#include "bake/encode/encode.h"

/* Raises peaks to those of samples; samples of kinds other than T do not count. */
void peaks_grow(float (*peak)[3], const struct encode_samples *samples, int lights);

/* Raises peaks to other ones. */
void peaks_join(float (*peak)[3], const float (*other)[3], int lights);

#endif
