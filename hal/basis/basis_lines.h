/* SPDX-License-Identifier: MIT */
/*
 * Columns of 8 bits, in which each line is stored as short as its values allow. Writer, reader and
 * compositor all use these functions.
 *
 * A record is one column:
 *
 *     uint8 code[panels8][channels]      padded with 0 to a multiple of BASIS_RECORD_ALIGN
 *     lines, in the same order, without gaps
 *
 * The code says how the BASIS_LINE8 values of a line are stored:
 *
 *     0                          no bytes: all values are 0
 *     1..BASIS_LINE_FACTOR_MAX   32 bytes: value k = (nibble k - 7) * code, nibble 0..14; nibbles
 *                                0..31 are the low halves of the bytes, 32..63 the high halves
 *     BASIS_LINE_WHOLE           64 bytes: the values themselves, -127..127
 */
#ifndef INLAY_HAL_BASIS_BASIS_LINES_H
#define INLAY_HAL_BASIS_BASIS_LINES_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "hal/basis/basis.h"
#include "hal/basis/basis_layout.h"

#define BASIS_RECORD_ALIGN 4
#define BASIS_RECORD_LINES 12	 /* largest number of lines: 4 panels of 3 channels */
#define BASIS_LINE_FACTOR_MAX 18 /* 18 * 7 < 128 */
#define BASIS_LINE_WHOLE 255
#define BASIS_LINE_MIDDLE 7 /* the nibble that stands for 0 */
#define BASIS_LINE_HALF (BASIS_LINE8 / 2)

static inline size_t basis_line_bytes(uint8_t code)
{
	return code == BASIS_LINE_WHOLE ? BASIS_LINE8 : code ? BASIS_LINE_HALF : 0;
}

/* Offset of the first line in a record of so many lines. */
static inline size_t basis_record_head(int lines)
{
	return (size_t)(lines + BASIS_RECORD_ALIGN - 1) / BASIS_RECORD_ALIGN * BASIS_RECORD_ALIGN;
}

static inline size_t basis_record_bytes(const uint8_t *code, int lines)
{
	size_t bytes = basis_record_head(lines);

	for (int k = 0; k < lines; k++)
		bytes += basis_line_bytes(code[k]);
	return bytes;
}

static inline int basis_record_lines(int pixels, int channels)
{
	return basis_panels8(pixels) * channels;
}

typedef uint16_t basis_words __attribute__((vector_size(16)));
typedef uint8_t basis_bytes __attribute__((vector_size(16)));

/* Unpacks one line to [BASIS_LINE8] values. */
static inline void basis_line_unpack(uint8_t code, const uint8_t *restrict from,
				     int8_t *restrict to)
{
	if (code == BASIS_LINE_WHOLE) {
		memcpy(to, from, BASIS_LINE8);
		return;
	}
	if (!code) {
		memset(to, 0, BASIS_LINE8);
		return;
	}
	/* Two bytes in each lane: 14 * 18 < 256, so no product carries into the other byte. */
	for (int k = 0; k < BASIS_LINE_HALF; k += (int)sizeof(basis_words)) {
		basis_words two, low, high;

		memcpy(&two, from + k, sizeof(two));
		low = (two & 0x0f0f) * code;
		high = (two >> 4 & 0x0f0f) * code;
		low = (basis_words)((basis_bytes)low - (uint8_t)(BASIS_LINE_MIDDLE * code));
		high = (basis_words)((basis_bytes)high - (uint8_t)(BASIS_LINE_MIDDLE * code));
		memcpy(to + k, &low, sizeof(low));
		memcpy(to + BASIS_LINE_HALF + k, &high, sizeof(high));
	}
}

/* Packs one line; the values must suit the code. Returns the number of bytes. */
static inline size_t basis_line_pack(uint8_t code, const int8_t *restrict from,
				     uint8_t *restrict to)
{
	if (code == BASIS_LINE_WHOLE)
		memcpy(to, from, BASIS_LINE8);
	else if (code)
		for (int k = 0; k < BASIS_LINE_HALF; k++)
			to[k] = (uint8_t)((from[k] / code + BASIS_LINE_MIDDLE) |
					  (from[BASIS_LINE_HALF + k] / code + BASIS_LINE_MIDDLE)
						  << 4);
	return basis_line_bytes(code);
}

/* Unpacks the line of one column, channel and panel to [BASIS_LINE8] values. */
static inline void basis_column8_line(const struct basis_block *b, int column, int channel,
				      int panel, int8_t *to)
{
	const uint8_t *code = b->record + b->record_at[column];
	const int line = panel * b->channels + channel;
	const uint8_t *from = code + basis_record_head(basis_record_lines(b->pixels, b->channels));

	for (int k = 0; k < line; k++)
		from += basis_line_bytes(code[k]);
	basis_line_unpack(code[line], from, to);
}

/* Value of pixel p in a column, in units of column_scale. */
static inline int basis_column8_value(const struct basis_block *b, int column, int channel, int p)
{
	const uint8_t *code = b->record + b->record_at[column];
	const int line = p / BASIS_LINE8 * b->channels + channel, k = p % BASIS_LINE8;
	const uint8_t *from = code + basis_record_head(basis_record_lines(b->pixels, b->channels));

	for (int n = 0; n < line; n++)
		from += basis_line_bytes(code[n]);
	if (!code[line])
		return 0;
	if (code[line] == BASIS_LINE_WHOLE)
		return (int8_t)from[k];
	return ((k < BASIS_LINE_HALF ? from[k] & 15 : from[k - BASIS_LINE_HALF] >> 4) -
		BASIS_LINE_MIDDLE) *
	       code[line];
}

#endif
