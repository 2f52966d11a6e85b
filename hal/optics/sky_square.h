/* SPDX-License-Identifier: MIT */
/*
 * The upper hemisphere as a square: the octahedral map (Praun and Hoppe, Spherical Parametrization
 * and Remeshing, 2003), turned so that its four upper faces fill the square. The zenith is in the
 * middle, the horizon is the edge. It needs no trigonometry.
 *
 *     (x, y, z) = d / (|d.x| + |d.y| + d.z)
 *     (u, v) = ((x + y + 1) / 2, (x - y + 1) / 2)        0..1
 */
#ifndef INLAY_HAL_OPTICS_SKY_SQUARE_H
#define INLAY_HAL_OPTICS_SKY_SQUARE_H

#include <math.h>

static inline void sky_square_of(const double d[3], double place[2])
{
	const double sum = fabs(d[0]) + fabs(d[1]) + d[2];

	place[0] = ((d[0] + d[1]) / sum + 1) / 2;
	place[1] = ((d[0] - d[1]) / sum + 1) / 2;
}

/* Sets the unit direction of a place. Returns the solid angle there, as sr per area of the square:
 *     2 / |(x, y, z)|^3        for area du dv, as dx dy = 2 du dv and the face has slope sqrt(3)
 */
static inline double sky_square_direction(const double place[2], double d[3])
{
	const double u = 2 * place[0] - 1, v = 2 * place[1] - 1;
	const double x = (u + v) / 2, y = (u - v) / 2, z = 1 - fabs(x) - fabs(y);
	const double length = sqrt(x * x + y * y + z * z);

	d[0] = x / length;
	d[1] = y / length;
	d[2] = z > 0 ? z / length : 0;
	return 2 / (length * length * length);
}

#endif
