/* SPDX-License-Identifier: MIT */
/*
 * Reads rows of the background, and copies it where the object changes nothing. Private to
 * hal/compositor; struct backdrop is in compositor.h.
 */
#ifndef INLAY_HAL_COMPOSITOR_BACKDROP_H
#define INLAY_HAL_COMPOSITOR_BACKDROP_H

#include "hal/compositor/compositor.h"

/* A rectangle of the picture. */
struct area {
	int x, y, width, height;
};

struct backdrop_rows {
	const uint8_t *pixels; /* first pixel of the area; upright BGRX */
	ptrdiff_t stride;
};

/* Returns the rows of an area: in place, or made or rotated into scratch[height][width]. */
struct backdrop_rows backdrop_rows(const struct backdrop *backdrop, struct area area,
				   uint8_t *scratch);

/* Copies rows to out, each code by way of recode[256] unless that is NULL. */
void backdrop_copy_rows(struct backdrop_rows rows, int width, int height, const uint8_t *recode,
			uint8_t *out, size_t out_stride);

/* Copies the area to out in the same way. scratch has room for a row of the area. */
void backdrop_copy(const struct backdrop *backdrop, struct area area, const uint8_t *recode,
		   uint8_t *scratch, uint8_t *out, size_t out_stride);

#endif
