/* SPDX-License-Identifier: MIT */
/*
 * Converts rows of Y'CbCr to BGRX in single precision, rounded: within 0.501 levels of the
 * definitions in ITU-R BT.601-7 and BT.709-6. (libyuv's conversion is faster, but on x86 its
 * coefficients end at 2; BT.709 blue needs 2.11 and is wrong by up to 15 levels.)
 */
#ifndef INLAY_HAL_FRAME_FRAME_YCBCR_H
#define INLAY_HAL_FRAME_FRAME_YCBCR_H

#include "hal/frame/frame.h"

struct ycbcr {
	float y_scale, y_offset; /* the offset includes 0.5 for rounding */
	float r_cr, g_cb, g_cr, b_cb;
};

void ycbcr_prepare(struct ycbcr *k, enum colour_matrix matrix, enum colour_range range);

/* Converts a row of width pixels; pairs of pixels share chroma, (width + 1) / 2 values of each. */
void ycbcr_row_halved(const struct ycbcr *k, const uint8_t *restrict y, const uint8_t *restrict cb,
		      const uint8_t *restrict cr, int width, uint32_t *restrict bgrx);

/* Converts a row in which each pixel has chroma of its own. */
void ycbcr_row_full(const struct ycbcr *k, const uint8_t *restrict y, const uint8_t *restrict cb,
		    const uint8_t *restrict cr, int width, uint32_t *restrict bgrx);

/* Convert count pixels of a camera's format, from the first of a pair on: the specification of
 * frame_rows.h. */
void ycbcr_row_yuyv(const struct ycbcr *k, const uint8_t *from, int count, uint32_t *bgrx);
void ycbcr_row_uyvy(const struct ycbcr *k, const uint8_t *from, int count, uint32_t *bgrx);
void ycbcr_row_nv12(const struct ycbcr *k, const uint8_t *y, const uint8_t *cbcr, int count,
		    uint32_t *bgrx);

/* Converts luma alone to grey. */
void ycbcr_row_grey(const struct ycbcr *k, const uint8_t *restrict y, int count,
		    uint32_t *restrict bgrx);

/* Reverses a row in place. */
void bgrx_row_reverse(uint32_t *bgrx, int count);

/* Expands R'G'B' of limited range (16 is black, 235 white) to full range in place; k is prepared
 * for RANGE_LIMITED. */
void ycbcr_row_expand(const struct ycbcr *k, int width, uint32_t *bgrx);

#endif
