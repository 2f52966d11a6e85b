/* SPDX-License-Identifier: MIT */
/*
 * Where each array of a block lies in its payload: the one place where writer, reader and encoder
 * agree on it.
 */
#ifndef INLAY_HAL_BASIS_BASIS_LAYOUT_H
#define INLAY_HAL_BASIS_BASIS_LAYOUT_H

#include <stddef.h>

#include "hal/basis/basis_format.h"

/* Coarse lights that a pattern is padded to, and pixels of a 16-bit line: 64 bytes, a cache line.
 */
#define BASIS_LINE16 32
#define BASIS_LINE8 64

struct basis_layout {
	int stride;	       /* int16 values of one pattern */
	int panels16, panels8; /* of coefficients and 16-bit columns; of 8-bit columns */
	/* Offsets from the start of the payload, in bytes; each array ends where the padding to the
	 * next one (to the end, for the last) begins. An array that is absent has no bytes. */
	size_t pixel, tint, pattern_scale, pattern, coefficient, light, column_scale;
	size_t column; /* 16 bits: values; 8: record_at */
	size_t record;
	size_t bytes; /* of the payload; a multiple of BASIS_ALIGN */
};

/* Of an entry's pixels, channels, bits, tinted, patterns, columns and record_bytes, all in their
 * ranges; coarse is K. Nothing overflows. */
struct basis_layout basis_layout(const struct basis_block_entry *entry, int coarse);

/* Lines that so many pixels, or coarse lights, take. */
static inline int basis_panels16(int pixels)
{
	return (pixels + BASIS_LINE16 - 1) / BASIS_LINE16;
}

static inline int basis_panels8(int pixels)
{
	return (pixels + BASIS_LINE8 - 1) / BASIS_LINE8;
}

/* Which line of 16 bits holds pattern or column `which`, of `count`, for one channel and panel. */
static inline size_t basis_line16(int panels16, int count, int channel, int panel, int which)
{
	return (size_t)(channel * panels16 + panel) * (size_t)count + (size_t)which;
}

#endif
