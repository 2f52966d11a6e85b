/* SPDX-License-Identifier: MIT */
/*
 * Maps the upper hemisphere to a square, for grids: the octahedral projection
 *     (u, v) = (x, y) / (|x| + |y| + z)
 * The horizon is the diamond |u| + |v| = 1. Within a quadrant it is a central projection onto a
 * plane, so straight lines are great circles. The distance of two directions on the square is at
 * most sqrt(3) times their angle.
 */
#ifndef INLAY_HAL_OPTICS_DOME_MAP_H
#define INLAY_HAL_OPTICS_DOME_MAP_H

#include <math.h>
#include <stdbool.h>

#define DOME_MAP_STRETCH 1.7320508075688774

/* Maps dir, z >= 0. False for an invalid dir: zero, NaN, infinity. */
static inline bool dome_map(const double dir[3], double uv[2])
{
	const double sum = fabs(dir[0]) + fabs(dir[1]) + dir[2];

	uv[0] = dir[0] / sum;
	uv[1] = dir[1] / sum;
	return sum > 0 && sum < INFINITY;
}

/* Row or column of a grid of side x side cells over -1..1. */
static inline int dome_map_cell(double u, int side)
{
	const double at = floor((u + 1) * (0.5 * side));

	return at < 0 ? 0 : at >= side ? side - 1 : (int)at;
}

#endif
