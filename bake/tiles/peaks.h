/* SPDX-License-Identifier: MIT */
/* The largest radiance that any pixel of the object gives off (BASIS_CHUNK_PEAK): [lights + 1][3],
 * per unit of each light, and under all of them. */
#ifndef INLAY_BAKE_TILES_PEAKS_H
#define INLAY_BAKE_TILES_PEAKS_H

#include "bake/encode/encode.h"

/* Grow to what these samples hold; only those of kind T count. */
void peaks_grow(float (*peak)[3], const struct encode_samples *samples, int lights);

/* Grow to what other peaks are. */
void peaks_join(float (*peak)[3], const float (*other)[3], int lights);

#endif
