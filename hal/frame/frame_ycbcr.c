/* SPDX-License-Identifier: MIT */
#include "hal/frame/frame_ycbcr.h"

#include <stddef.h>

void ycbcr_prepare(struct ycbcr *k, enum colour_matrix matrix, enum colour_range range)
{
	const double kr = matrix == MATRIX_BT709 ? 0.2126 : 0.299;
	const double kb = matrix == MATRIX_BT709 ? 0.0722 : 0.114;
	const double kg = 1 - kr - kb;
	const double luma = range == RANGE_FULL ? 1 : 255.0 / 219;
	const double chroma = range == RANGE_FULL ? 1 : 255.0 / 224;

	k->y_scale = (float)luma;
	k->y_offset = (float)(0.5 - (range == RANGE_FULL ? 0 : 16 * luma));
	k->r_cr = (float)(chroma * 2 * (1 - kr));
	k->b_cb = (float)(chroma * 2 * (1 - kb));
	k->g_cr = (float)(-chroma * 2 * (1 - kr) * kr / kg);
	k->g_cb = (float)(-chroma * 2 * (1 - kb) * kb / kg);
}

static inline uint32_t code_value(float v)
{
	v = v < 0 ? 0 : v;
	v = v < 255 ? v : 255;
	return (uint32_t)(int)v;
}

static inline uint32_t bgrx_pixel(const struct ycbcr *k, uint8_t y, float r, float g, float b)
{
	const float luma = k->y_scale * y + k->y_offset;

	return code_value(luma + b) | code_value(luma + g) << 8 | code_value(luma + r) << 16 |
	       UINT32_C(255) << 24;
}

void ycbcr_row_halved(const struct ycbcr *k, const uint8_t *restrict y, const uint8_t *restrict cb,
		      const uint8_t *restrict cr, int width, uint32_t *restrict bgrx)
{
	const struct ycbcr m = *k;
	const int pairs = width / 2;

	for (int i = 0; i < pairs; i++) {
		const float u = (float)cb[i] - 128, v = (float)cr[i] - 128;
		const float r = m.r_cr * v, g = m.g_cb * u + m.g_cr * v, b = m.b_cb * u;

		bgrx[2 * i] = bgrx_pixel(&m, y[2 * i], r, g, b);
		bgrx[2 * i + 1] = bgrx_pixel(&m, y[2 * i + 1], r, g, b);
	}
	if (width % 2)
		ycbcr_row_full(k, y + 2 * pairs, cb + pairs, cr + pairs, 1, bgrx + 2 * pairs);
}

void ycbcr_row_full(const struct ycbcr *k, const uint8_t *restrict y, const uint8_t *restrict cb,
		    const uint8_t *restrict cr, int width, uint32_t *restrict bgrx)
{
	const struct ycbcr m = *k;

	for (int i = 0; i < width; i++) {
		const float u = (float)cb[i] - 128, v = (float)cr[i] - 128;

		bgrx[i] = bgrx_pixel(&m, y[i], m.r_cr * v, m.g_cb * u + m.g_cr * v, m.b_cb * u);
	}
}

/* Packed rows are split into planes of so many pixels at a time, which compilers vectorise well. */
enum { CHUNK = 256 };

/* y_step, pair_step: bytes from one luma value to the next, and from one chroma pair to the
 * next. */
static void row_packed(const struct ycbcr *k, const uint8_t *y, int y_step, const uint8_t *cb,
		       const uint8_t *cr, int pair_step, int count, uint32_t *bgrx)
{
	uint8_t luma[CHUNK], blue[CHUNK / 2], red[CHUNK / 2];

	for (int done = 0; done < count; done += CHUNK) {
		const int now = count - done < CHUNK ? count - done : CHUNK;

		for (int i = 0; i < now; i++)
			luma[i] = y[(size_t)(done + i) * (size_t)y_step];
		for (int i = 0; i < (now + 1) / 2; i++) {
			blue[i] = cb[(size_t)(done / 2 + i) * (size_t)pair_step];
			red[i] = cr[(size_t)(done / 2 + i) * (size_t)pair_step];
		}
		ycbcr_row_halved(k, luma, blue, red, now, bgrx + done);
	}
}

void ycbcr_row_yuyv(const struct ycbcr *k, const uint8_t *from, int count, uint32_t *bgrx)
{
	row_packed(k, from, 2, from + 1, from + 3, 4, count, bgrx);
}

void ycbcr_row_uyvy(const struct ycbcr *k, const uint8_t *from, int count, uint32_t *bgrx)
{
	row_packed(k, from + 1, 2, from, from + 2, 4, count, bgrx);
}

void ycbcr_row_nv12(const struct ycbcr *k, const uint8_t *y, const uint8_t *cbcr, int count,
		    uint32_t *bgrx)
{
	row_packed(k, y, 1, cbcr, cbcr + 1, 2, count, bgrx);
}

void ycbcr_row_grey(const struct ycbcr *k, const uint8_t *restrict y, int count,
		    uint32_t *restrict bgrx)
{
	const struct ycbcr m = *k;

	for (int i = 0; i < count; i++)
		bgrx[i] = bgrx_pixel(&m, y[i], 0, 0, 0);
}

void bgrx_row_reverse(uint32_t *bgrx, int count)
{
	for (int i = 0, j = count - 1; i < j; i++, j--) {
		const uint32_t left = bgrx[i];

		bgrx[i] = bgrx[j];
		bgrx[j] = left;
	}
}

void ycbcr_row_expand(const struct ycbcr *k, int width, uint32_t *bgrx)
{
	const struct ycbcr m = *k;

	for (int i = 0; i < width; i++) {
		const uint32_t b = code_value(m.y_scale * (uint8_t)bgrx[i] + m.y_offset);
		const uint32_t g = code_value(m.y_scale * (uint8_t)(bgrx[i] >> 8) + m.y_offset);
		const uint32_t r = code_value(m.y_scale * (uint8_t)(bgrx[i] >> 16) + m.y_offset);

		bgrx[i] = b | g << 8 | r << 16 | UINT32_C(255) << 24;
	}
}
