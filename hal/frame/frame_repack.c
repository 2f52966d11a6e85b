/* SPDX-License-Identifier: MIT */
#include "hal/frame/frame_repack.h"

#include <string.h>

static const uint8_t *row_of(const struct frame *frame, int plane, int y)
{
	return frame->planes[plane].data + (size_t)y * frame->planes[plane].stride;
}

static unsigned word_at(const uint8_t *words, int i)
{
	return words[2 * i] | (unsigned)words[2 * i + 1] << 8;
}

/* Limited range of ten bits is four times that of eight (BT.709, table 4). */
static uint8_t ten_to_eight(unsigned word)
{
	const unsigned rounded = ((word >> 6) + 2) >> 2;

	return (uint8_t)(rounded < 255 ? rounded : 255);
}

/* Cb and Cr of half as many pixels, in planes of their own. */
static void interleave(const uint8_t *cb, const uint8_t *cr, int pairs, uint8_t *cbcr)
{
	for (int i = 0; i < pairs; i++) {
		cbcr[2 * i] = cb[i];
		cbcr[2 * i + 1] = cr[i];
	}
}

static void repack_yvyu(const uint8_t *from, int count, int pairs, uint8_t *luma, uint8_t *cbcr)
{
	for (int i = 0; i < count; i++)
		luma[i] = from[2 * i];
	for (int i = 0; i < pairs; i++) {
		cbcr[2 * i] = from[4 * i + 3];
		cbcr[2 * i + 1] = from[4 * i + 1];
	}
}

static void repack_p010(const uint8_t *words, const uint8_t *chroma, int count, int pairs,
			uint8_t *luma, uint8_t *cbcr)
{
	for (int i = 0; i < count; i++)
		luma[i] = ten_to_eight(word_at(words, i));
	for (int i = 0; i < 2 * pairs; i++)
		cbcr[i] = ten_to_eight(word_at(chroma, i));
}

void frame_repack_ycbcr(const struct frame *frame, int x, int y, int count, uint8_t *luma,
			uint8_t *cbcr)
{
	const enum pixel_format format = frame->format;
	const int pairs = (count + 1) / 2, half = x / 2;
	const uint8_t *row = row_of(frame, 0, y) + frame_plane_stride(format, 0, x);
	const int down = pixel_format_halves_rows(format) ? y / 2 : y;
	const uint8_t *chroma = NULL;

	if (frame_plane_count(format) > 1)
		chroma = row_of(frame, 1, down) + frame_plane_stride(format, 1, x);
	switch (format) {
	case PIXEL_YVYU:
		repack_yvyu(row, count, pairs, luma, cbcr);
		return;
	case PIXEL_P010:
		repack_p010(row, chroma, count, pairs, luma, cbcr);
		return;
	case PIXEL_YU12:
		interleave(chroma, row_of(frame, 2, down) + half, pairs, cbcr);
		break;
	case PIXEL_YV12:
		interleave(row_of(frame, 2, down) + half, chroma, pairs, cbcr);
		break;
	case PIXEL_NV21:
		for (int i = 0; i < pairs; i++) {
			cbcr[2 * i] = chroma[2 * i + 1];
			cbcr[2 * i + 1] = chroma[2 * i];
		}
		break;
	default: /* NV12, NV16 */
		memcpy(cbcr, chroma, 2 * (size_t)pairs);
	}
	memcpy(luma, row, (size_t)count);
}

void frame_repack_grey(const struct frame *frame, int x, int y, int count, uint8_t *grey)
{
	static const uint16_t whites[PIXEL_FORMAT_COUNT] = {[PIXEL_Y10] = 1023,
							    [PIXEL_Y12] = 4095,
							    [PIXEL_Y14] = 16383,
							    [PIXEL_Y16] = 65535,
							    [PIXEL_Z16] = 8191};
	const unsigned white = whites[frame->format];
	const uint8_t *words = row_of(frame, 0, y) + 2 * (size_t)x;

	for (int i = 0; i < count; i++) {
		const unsigned word = word_at(words, i);
		const bool beyond = frame->format == PIXEL_Z16 && word > white;

		grey[i] = (uint8_t)(((beyond ? white : word & white) * 255 + white / 2) / white);
	}
}
