/* SPDX-License-Identifier: MIT */
/*
 * The background as rows that can be read, and what is only copied from it. Private to
 * hal/compositor.
 */
#ifndef INLAY_HAL_COMPOSITOR_BACKDROP_H
#define INLAY_HAL_COMPOSITOR_BACKDROP_H

#include "hal/compositor/compositor.h"

/* A rectangle of the picture. */
struct area {
	int x, y, width, height;
};

struct backdrop_rows {
	const uint8_t *pixels; /* BGRX, upright, of the area's first pixel */
	ptrdiff_t stride;
};

/* The area's rows: where they lie, or made or turned into scratch[height][width]. */
struct backdrop_rows backdrop_rows(const struct backdrop *backdrop, struct area area,
				   uint8_t *scratch);

/* Copies the area to out, each code through recode[256] unless that is NULL. scratch holds a row as
 * long as the area. */
void backdrop_copy(const struct backdrop *backdrop, struct area area, const uint8_t *recode,
		   uint8_t *scratch, uint8_t *out, size_t out_stride);

#endif
