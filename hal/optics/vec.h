/* SPDX-License-Identifier: MIT */
/* Vectors of three doubles, and 3 x 3 matrices row by row. World: right-handed, Z up, the ground is
 * Z = 0. */
#ifndef INLAY_HAL_OPTICS_VEC_H
#define INLAY_HAL_OPTICS_VEC_H

#include <math.h>

static inline double vec_dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void vec_cross(const double a[3], const double b[3], double out[3])
{
	const double x = a[1] * b[2] - a[2] * b[1];
	const double y = a[2] * b[0] - a[0] * b[2];

	out[2] = a[0] * b[1] - a[1] * b[0];
	out[0] = x;
	out[1] = y;
}

static inline double vec_length(const double a[3])
{
	return sqrt(vec_dot(a, a));
}

/* Scales a vector to length 1; leaves a zero vector unchanged. Returns the length before. */
static inline double vec_normalize(double a[3])
{
	const double length = vec_length(a);

	if (length > 0) {
		a[0] /= length;
		a[1] /= length;
		a[2] /= length;
	}
	return length;
}

/* Angle between two unit vectors, rad; exact for small angles, where acos() loses digits. */
static inline double vec_angle(const double a[3], const double b[3])
{
	const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};

	return 2 * asin(fmin(0.5 * vec_length(d), 1));
}

/* Two unit vectors across a unit vector, and across each other. */
static inline void vec_across(const double v[3], double across[2][3])
{
	const double flat = fabs(v[0]) < 0.6, axis[3] = {flat, 1 - flat, 0};

	vec_cross(v, axis, across[0]);
	vec_normalize(across[0]);
	vec_cross(v, across[0], across[1]);
}

/* out = M v */
static inline void mat_apply(const double m[9], const double v[3], double out[3])
{
	const double x = m[0] * v[0] + m[1] * v[1] + m[2] * v[2];
	const double y = m[3] * v[0] + m[4] * v[1] + m[5] * v[2];

	out[2] = m[6] * v[0] + m[7] * v[1] + m[8] * v[2];
	out[0] = x;
	out[1] = y;
}

/* out = M^T v; M^T is the inverse of a rotation M. */
static inline void mat_apply_transposed(const double m[9], const double v[3], double out[3])
{
	const double x = m[0] * v[0] + m[3] * v[1] + m[6] * v[2];
	const double y = m[1] * v[0] + m[4] * v[1] + m[7] * v[2];

	out[2] = m[2] * v[0] + m[5] * v[1] + m[8] * v[2];
	out[0] = x;
	out[1] = y;
}

#endif
