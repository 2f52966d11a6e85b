/* SPDX-License-Identifier: MIT */
/* Rows of rarer formats, repacked as those of NV12 and of grey, which frame_rows.h converts. */
#ifndef INLAY_HAL_FRAME_FRAME_REPACK_H
#define INLAY_HAL_FRAME_FRAME_REPACK_H

#include "hal/frame/frame.h"

/* Repacks a part of a row of any Y'CbCr format: count bytes of luma, and as many of Cb and Cr in
 * turn (one more if count is odd). x is even. Ten bits are rounded to eight. */
void frame_repack_ycbcr(const struct frame *frame, int x, int y, int count, uint8_t *luma,
			uint8_t *cbcr);

/* The same of PIXEL_Y10 to PIXEL_Y16, and of PIXEL_Z16. White stays white: the greatest word
 * becomes 255, and depths of 8191 and more. */
void frame_repack_grey(const struct frame *frame, int x, int y, int count, uint8_t *grey);

#endif
