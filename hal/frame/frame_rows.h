/* SPDX-License-Identifier: MIT */
/*
 * Rows of raw video to BGRX, one table of functions for each instruction set.
 *
 * frame_ycbcr.c is the specification: every table gives its bits for every input. What is read and
 * written is what count pixels need, nothing beyond; what is read need not be aligned. BGRX is
 * written with X = 255. Each byte is read once, in order.
 */
#ifndef INLAY_HAL_FRAME_FRAME_ROWS_H
#define INLAY_HAL_FRAME_FRAME_ROWS_H

#include <stdint.h>

#include "hal/frame/frame_ycbcr.h"

struct frame_rows {
	const char *name; /* "c", "avx2", "avx512", "neon" */
	unsigned needs;	  /* of the processor: enum processor_feature */

	/* count pixels from the first of a pair that shares chroma; of an odd number the last has a
	 * whole pair's bytes too. */
	void (*yuyv)(const struct ycbcr *k, const uint8_t *from, int count, uint32_t *bgrx);
	void (*uyvy)(const struct ycbcr *k, const uint8_t *from, int count, uint32_t *bgrx);
	void (*nv12)(const struct ycbcr *k, const uint8_t *y, const uint8_t *cbcr, int count,
		     uint32_t *bgrx);
	void (*grey)(const struct ycbcr *k, const uint8_t *y, int count, uint32_t *bgrx);

	/* A row of BGRX back to front, in place. */
	void (*reverse)(uint32_t *bgrx, int count);
};

/* The tables that this program was built with, the specification first, the fastest last, then
 * NULL. */
extern const struct frame_rows *const frame_rows_all[];

/* The fastest that the processor has and the environment's INLAY_KERNEL allows (processor.h). */
const struct frame_rows *frame_rows_choose(void);

#endif
