/* SPDX-License-Identifier: MIT */
/*
 * The offset of each array in the payload of a block. Writer, reader and encoder all use it.
 */
#ifndef INLAY_HAL_BASIS_BASIS_LAYOUT_H
#define INLAY_HAL_BASIS_BASIS_LAYOUT_H

#include <stddef.h>

#include "hal/basis/basis_format.h"

/* Values of a line of 64 bytes, a cache line. A pattern is padded to a multiple of BASIS_LINE16
 * coarse lights. */
#define BASIS_LINE16 32
#define BASIS_LINE8 64

struct basis_layout {
	int stride;	       /* int16 values of one pattern, padding included */
	int panels16, panels8; /* panels of coefficients and 16-bit columns; of 8-bit columns */
	/* Offsets from the start of the payload, in bytes. Padding follows each array, up to the
	 * next one or to the end. An absent array has no bytes. */
	size_t pixel, tint, pattern_scale, pattern, coefficient, light, column_scale;
	size_t column; /* 16 bits: values; 8 bits: record_at */
	size_t record;
	size_t bytes; /* length of the payload; a multiple of BASIS_ALIGN */
};

/* Uses pixels, channels, bits, tinted, patterns, columns and record_bytes of the entry, which must
 * be in their ranges; then nothing overflows. coarse is K. */
struct basis_layout basis_layout(const struct basis_block_entry *entry, int coarse);

/* Number of lines of 16-bit values for so many pixels, or coarse lights. */
static inline int basis_panels16(int pixels)
{
	return (pixels + BASIS_LINE16 - 1) / BASIS_LINE16;
}

static inline int basis_panels8(int pixels)
{
	return (pixels + BASIS_LINE8 - 1) / BASIS_LINE8;
}

/* Index of the 16-bit line of pattern or column `which`, of `count`, in one channel and panel. */
static inline size_t basis_line16(int panels16, int count, int channel, int panel, int which)
{
	return (size_t)(channel * panels16 + panel) * (size_t)count + (size_t)which;
}

#endif
