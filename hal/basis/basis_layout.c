/* SPDX-License-Identifier: MIT */
#include "hal/basis/basis_layout.h"

static size_t align_up(size_t bytes)
{
	return (bytes + BASIS_ALIGN - 1) / BASIS_ALIGN * BASIS_ALIGN;
}

struct basis_layout basis_layout(const struct basis_block_entry *entry, int coarse)
{
	const size_t pixels = entry->pixels, channels = entry->channels;
	const size_t patterns = entry->patterns, columns = entry->columns;
	struct basis_layout at;

	at.stride = basis_panels16(coarse) * BASIS_LINE16;
	at.panels16 = basis_panels16(entry->pixels);
	at.panels8 = basis_panels8(entry->pixels);
	at.pixel = 0;
	at.tint = align_up(pixels * sizeof(uint16_t));
	at.pattern_scale = at.tint + (entry->tinted ? align_up(3 * pixels * sizeof(uint16_t)) : 0);
	at.pattern = at.pattern_scale + align_up(patterns * sizeof(float));
	at.coefficient = at.pattern + patterns * (size_t)at.stride * sizeof(int16_t);
	at.light = at.coefficient + (size_t)at.panels16 * channels * patterns * BASIS_ALIGN;
	at.column_scale = at.light + align_up(columns * sizeof(uint16_t));
	at.column = at.column_scale + align_up(columns * sizeof(float));
	at.record = at.column;
	if (entry->bits == 8)
		at.record += align_up(columns * sizeof(uint32_t));
	at.bytes = entry->bits == 8
			   ? at.record + align_up(entry->record_bytes)
			   : at.column + (size_t)at.panels16 * channels * columns * BASIS_ALIGN;
	return at;
}
