/* SPDX-License-Identifier: MIT */
/* Peaks are the largest radiance of any pixel of the object (BASIS_CHUNK_PEAK), [lights + 1][3]:
 * one for each light of radiance 1, and the last under all of them. */
#ifndef INLAY_BAKE_TILES_PEAKS_H
#define INLAY_BAKE_TILES_PEAKS_H

#include "bake/encode/encode.h"

/* Raises peaks to those of the samples of kind T; other kinds do not count. */
void peaks_grow(float (*peak)[3], const struct encode_samples *samples, int lights);

/* Raises peaks to others where these are larger. */
void peaks_join(float (*peak)[3], const float (*other)[3], int lights);

#endif
