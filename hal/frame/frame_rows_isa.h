/* SPDX-License-Identifier: MIT */
/* Private to hal/frame/frame_rows*.c: the tables, each in a file compiled for its instruction
 * set. */
#ifndef INLAY_HAL_FRAME_FRAME_ROWS_ISA_H
#define INLAY_HAL_FRAME_FRAME_ROWS_ISA_H

#include "hal/frame/frame_rows.h"

extern const struct frame_rows frame_rows_c;
extern const struct frame_rows frame_rows_avx2;
extern const struct frame_rows frame_rows_avx512;
extern const struct frame_rows frame_rows_neon;

#endif
