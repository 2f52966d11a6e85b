/* SPDX-License-Identifier: MIT */
/*
 * Rows of Y'CbCr to BGRX, rounded from single precision: within 0.501 levels of the definitions in
 * ITU-R BT.601-7 and BT.709-6. (libyuv's own conversion is faster, but on x86 its coefficients stop
 * at 2: BT.709 blue, which needs 2.11, is off by up to 15 levels.)
 */
#ifndef INLAY_HAL_FRAME_FRAME_YCBCR_H
#define INLAY_HAL_FRAME_FRAME_YCBCR_H

#include "hal/frame/frame.h"

struct ycbcr {
	float y_scale, y_offset; /* half a level for rounding is in the offset */
	float r_cr, g_cb, g_cr, b_cb;
};

void ycbcr_prepare(struct ycbcr *k, enum colour_matrix matrix, enum colour_range range);

/* One row of width pixels; chroma is shared by pairs, (width + 1) / 2 of each. */
void ycbcr_row_halved(const struct ycbcr *k, const uint8_t *restrict y, const uint8_t *restrict cb,
		      const uint8_t *restrict cr, int width, uint32_t *restrict bgrx);

/* The same with chroma of its own for each pixel. */
void ycbcr_row_full(const struct ycbcr *k, const uint8_t *restrict y, const uint8_t *restrict cb,
		    const uint8_t *restrict cr, int width, uint32_t *restrict bgrx);

/* The same from what cameras send, count pixels from the first of a pair: the specification of
 * frame_rows.h. */
void ycbcr_row_yuyv(const struct ycbcr *k, const uint8_t *from, int count, uint32_t *bgrx);
void ycbcr_row_uyvy(const struct ycbcr *k, const uint8_t *from, int count, uint32_t *bgrx);
void ycbcr_row_nv12(const struct ycbcr *k, const uint8_t *y, const uint8_t *cbcr, int count,
		    uint32_t *bgrx);

/* The same without colour. */
void ycbcr_row_grey(const struct ycbcr *k, const uint8_t *restrict y, int count,
		    uint32_t *restrict bgrx);

/* Back to front, in place. */
void bgrx_row_reverse(uint32_t *bgrx, int count);

/* R'G'B' of limited range (16 is black, 235 white) to full range, in place; k as for RANGE_LIMITED.
 */
void ycbcr_row_expand(const struct ycbcr *k, int width, uint32_t *bgrx);

#endif
