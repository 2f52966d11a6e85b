/* SPDX-License-Identifier: MIT */
/* Vectors and colours of three floats, for ray tracing. World coordinates: right-handed, Z up, the
 * ground is Z = 0. */
#ifndef INLAY_BAKE_BASE_VEC3_H
#define INLAY_BAKE_BASE_VEC3_H

#include <math.h>

#define PI_F 3.14159265358979f

struct v3 {
	float x, y, z;
};

/* Linear light, or a reflectance, in three channels. */
struct rgb {
	float c[3];
};

static inline struct v3 v3_make(float x, float y, float z)
{
	return (struct v3){x, y, z};
}

static inline struct v3 v3_add(struct v3 a, struct v3 b)
{
	return v3_make(a.x + b.x, a.y + b.y, a.z + b.z);
}

static inline struct v3 v3_sub(struct v3 a, struct v3 b)
{
	return v3_make(a.x - b.x, a.y - b.y, a.z - b.z);
}

static inline struct v3 v3_scale(struct v3 a, float s)
{
	return v3_make(a.x * s, a.y * s, a.z * s);
}

/* a + s b */
static inline struct v3 v3_mad(struct v3 a, float s, struct v3 b)
{
	return v3_make(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z);
}

static inline float v3_dot(struct v3 a, struct v3 b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline struct v3 v3_cross(struct v3 a, struct v3 b)
{
	return v3_make(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

static inline float v3_length(struct v3 a)
{
	return sqrtf(v3_dot(a, a));
}

/* Unit vector of the same direction. A zero vector stays zero. */
static inline struct v3 v3_unit(struct v3 a)
{
	const float length = v3_length(a);

	return length > 0 ? v3_scale(a, 1 / length) : a;
}

/* Right-handed orthonormal frame s, t, n around unit n (Duff et al., Building an Orthonormal Basis,
 * Revisited, 2017). */
static inline void v3_frame(struct v3 n, struct v3 *s, struct v3 *t)
{
	const float sign = copysignf(1.0f, n.z);
	const float a = -1.0f / (sign + n.z);
	const float b = n.x * n.y * a;

	*s = v3_make(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x);
	*t = v3_make(b, sign + n.y * n.y * a, -n.y);
}

/* s, t, n coordinates to world coordinates. */
static inline struct v3 v3_from_frame(struct v3 local, struct v3 s, struct v3 t, struct v3 n)
{
	return v3_mad(v3_mad(v3_scale(s, local.x), local.y, t), local.z, n);
}

static inline struct rgb rgb_make(float r, float g, float b)
{
	return (struct rgb){{r, g, b}};
}

static inline struct rgb rgb_scale(struct rgb a, float s)
{
	return rgb_make(a.c[0] * s, a.c[1] * s, a.c[2] * s);
}

static inline struct rgb rgb_mul(struct rgb a, struct rgb b)
{
	return rgb_make(a.c[0] * b.c[0], a.c[1] * b.c[1], a.c[2] * b.c[2]);
}

static inline struct rgb rgb_add(struct rgb a, struct rgb b)
{
	return rgb_make(a.c[0] + b.c[0], a.c[1] + b.c[1], a.c[2] + b.c[2]);
}

/* Largest magnitude of the three channels. */
static inline float rgb_peak(struct rgb a)
{
	return fmaxf(fabsf(a.c[0]), fmaxf(fabsf(a.c[1]), fabsf(a.c[2])));
}

#endif
