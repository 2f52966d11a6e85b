/*
 * Where each array of a block lies in its payload: the one place where writer, reader and encoder
 * agree on it.
 */
#ifndef INLAY_HAL_BASIS_BASIS_LAYOUT_H
#define INLAY_HAL_BASIS_BASIS_LAYOUT_H

#include <stddef.h>

#include "hal/basis/basis_format.h"

/* Lights a row is padded to: 64 bytes, a cache line. */
#define BASIS_ROW_STEP 32

struct basis_layout {
	int stride;	    /* int16 values of one row */
	int total_channels; /* 3 for V, else the block's channels */
	/* Offsets from the start of the payload, in bytes; each array ends where the padding to the
	 * next one (to the end, for row) begins. */
	size_t pixel, light, scale, total, row;
	size_t bytes; /* of the payload; a multiple of BASIS_ALIGN */
};

/* pixels 1..256, channels 1 or 3, lights 1..BASIS_LIGHTS_MAX: nothing overflows. */
struct basis_layout basis_layout(enum basis_kind kind, int pixels, int channels, int lights);

#endif
