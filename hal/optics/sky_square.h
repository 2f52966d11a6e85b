/* SPDX-License-Identifier: MIT */
/*
 * The upper hemisphere as a disc in a square: the stereographic projection, which keeps angles, so
 * that what is round in the square is round in the sky. It needs no trigonometry.
 *
 *     (x, y) = (d.x, d.y) / (1 + d.z)                 the horizon is the unit circle
 *     (u, v) = (x, y) / (2 SKY_SQUARE_EDGE) + 1/2     0..1, with a margin around the disc
 */
#ifndef INLAY_HAL_OPTICS_SKY_SQUARE_H
#define INLAY_HAL_OPTICS_SKY_SQUARE_H

#include <math.h>

/* The margin is as wide as the largest blur at the horizon should find the horizon's light in. */
#define SKY_SQUARE_EDGE 1.0625

/* d need not be unit, and points upwards. */
static inline void sky_square_of(const double d[3], double place[2])
{
	const double sum = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) + d[2];

	for (int k = 0; k < 2; k++)
		place[k] = d[k] / sum / (2 * SKY_SQUARE_EDGE) + 0.5;
}

/*
 * Sets the unit direction of a place; in the margin, the nearest at the horizon. Returns the solid
 * angle there, as sr per area of the square; 0 in the margin:
 *     (2 SKY_SQUARE_EDGE)^2 * 4 / (1 + x^2 + y^2)^2
 */
static inline double sky_square_direction(const double place[2], double d[3])
{
	const double x = (2 * place[0] - 1) * SKY_SQUARE_EDGE;
	const double y = (2 * place[1] - 1) * SKY_SQUARE_EDGE;
	const double r2 = x * x + y * y;

	if (r2 > 1) {
		d[0] = x / sqrt(r2);
		d[1] = y / sqrt(r2);
		d[2] = 0;
		return 0;
	}
	d[0] = 2 * x / (1 + r2);
	d[1] = 2 * y / (1 + r2);
	d[2] = (1 - r2) / (1 + r2);
	return 16 * SKY_SQUARE_EDGE * SKY_SQUARE_EDGE / ((1 + r2) * (1 + r2));
}

#endif
