/* SPDX-License-Identifier: MIT */
/*
 * Conversion of rows of raw video to BGRX, one table of functions for each instruction set.
 *
 * frame_ycbcr.c is the specification: every table gives the same bits for every input. The
 * functions read and write the bytes of count pixels and none beyond; the input need not be
 * aligned. They write BGRX with X = 255, and read each byte once, in order.
 */
#ifndef INLAY_HAL_FRAME_FRAME_ROWS_H
#define INLAY_HAL_FRAME_FRAME_ROWS_H

#include <stdint.h>

#include "hal/frame/frame_ycbcr.h"

struct frame_rows {
	const char *name; /* "c", "avx2", "avx512", "neon" */
	unsigned needs;	  /* enum processor_feature, or'ed */

	/* Convert count pixels that begin with the first of a pair with common chroma. If count is
	 * odd, the last pixel still has the bytes of a whole pair. */
	void (*yuyv)(const struct ycbcr *k, const uint8_t *from, int count, uint32_t *bgrx);
	void (*uyvy)(const struct ycbcr *k, const uint8_t *from, int count, uint32_t *bgrx);
	void (*nv12)(const struct ycbcr *k, const uint8_t *y, const uint8_t *cbcr, int count,
		     uint32_t *bgrx);
	void (*grey)(const struct ycbcr *k, const uint8_t *y, int count, uint32_t *bgrx);

	/* Reverses a row of BGRX in place. */
	void (*reverse)(uint32_t *bgrx, int count);
};

/* The tables in this program, from the C one to the fastest, then NULL. */
extern const struct frame_rows *const frame_rows_all[];

/* The fastest table that the processor and the environment variable INLAY_KERNEL allow
 * (processor.h). */
const struct frame_rows *frame_rows_choose(void);

/* Private to hal/frame/frame_rows*.c: the tables, each in a file compiled for its instruction
 * set. */

extern const struct frame_rows frame_rows_c;
extern const struct frame_rows frame_rows_avx2;
extern const struct frame_rows frame_rows_neon;

#endif
