/* SPDX-License-Identifier: MIT */
#include "bake/demo/cow_coat.h"

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "bake/demo/cow_shape.h"
#include "hal/optics/vec.h"

#define COUNT(array) (sizeof(array) / sizeof(*(array)))

/* Half the width over which one colour turns into the next: about a texel. */
#define EDGE 0.0007

static const double white[3] = {0.93, 0.905, 0.86};
static const double brown[3] = {0.36, 0.205, 0.13};
static const double pink[3] = {0.92, 0.665, 0.62};
static const double rose[3] = {0.86, 0.545, 0.51};
static const double cream[3] = {0.84, 0.75, 0.58};
static const double horn_tip[3] = {0.42, 0.33, 0.25};
static const double dark[3] = {0.21, 0.16, 0.14};

/* The patches: placed by hand, no two alike. */
static const struct ellipsoid patch[] = {
	{.centre = {0.085, 0.195, -0.020}, .radius = {0.060, 0.046, 0.052}, .turn_deg = {20, 0, 0}},
	{.centre = {0.070, 0.215, -0.120}, .radius = {0.040, 0.038, 0.030}},
	{.centre = {0.075, 0.150, 0.070}, .radius = {0.036, 0.030, 0.026}},
	{.centre = {-0.080, 0.210, 0.045},
	 .radius = {0.060, 0.048, 0.040},
	 .turn_deg = {-25, 0, 0}},
	{.centre = {-0.085, 0.165, -0.085}, .radius = {0.055, 0.052, 0.048}},
	{.centre = {0.0, 0.265, -0.060}, .radius = {0.048, 0.022, 0.040}},
	{.centre = {0.046, 0.320, 0.170}, .radius = {0.036, 0.040, 0.046}},
	{.centre = {-0.055, 0.350, 0.140}, .radius = {0.040, 0.026, 0.036}},
	{.centre = {-0.047, 0.075, 0.085}, .radius = {0.030, 0.018, 0.030}},
	{.centre = {0.055, 0.085, -0.115}, .radius = {0.030, 0.022, 0.026}},
};

/* A fixed number in -1..1 for each point of the integer grid. */
static double noise_lattice(int x, int y, int z)
{
	uint32_t h = (uint32_t)x * 0x8da6b343u ^ (uint32_t)y * 0xd8163841u ^
		     (uint32_t)z * 0xcb1ab31fu;

	h ^= h >> 15;
	h *= 0x2c1b3c6du;
	h ^= h >> 12;
	h *= 0x297a2d39u;
	h ^= h >> 15;
	return h / 2147483647.5 - 1;
}

/* Smooth noise, -1..1, with details of about `size`. */
static double smooth_noise(const double p[3], double size)
{
	int cell[3];
	double t[3], sum = 0;

	for (int i = 0; i < 3; i++) {
		const double at = p[i] / size + 100;

		cell[i] = (int)floor(at);
		t[i] = at - cell[i];
		t[i] = t[i] * t[i] * (3 - 2 * t[i]);
	}
	for (int k = 0; k < 8; k++) {
		const int dx = k & 1, dy = k >> 1 & 1, dz = k >> 2;
		const double weight = (dx ? t[0] : 1 - t[0]) * (dy ? t[1] : 1 - t[1]) *
				      (dz ? t[2] : 1 - t[2]);

		sum += weight * noise_lattice(cell[0] + dx, cell[1] + dy, cell[2] + dz);
	}
	return sum;
}

static double coat_patches(const double p[3])
{
	const double wave = 0.007 * smooth_noise(p, 0.034) + 0.003 * smooth_noise(p, 0.013);
	struct implicit f = {.value = 1};

	for (size_t k = 0; k < COUNT(patch); k++)
		f = implicit_union(f, implicit_ellipsoid(&patch[k], p), 0.012);
	return f.value + wave;
}

/* 1 inside (where < 0), 0 outside, a smooth step of twice the width between. */
static double share_inside(double where, double width)
{
	const double t = fmin(fmax(0.5 - where / (2 * width), 0), 1);

	return t * t * (3 - 2 * t);
}

static void blend_colour(double rgb[3], const double colour[3], double amount)
{
	for (int i = 0; i < 3; i++)
		rgb[i] += amount * (colour[i] - rgb[i]);
}

/* A smile: a thin arc under the nostrils, given by its height over x on the muzzle's front. */
static double mouth_arc(const double p[3])
{
	const double line = 0.2575 + 9.0 * p[0] * p[0];
	const double away = fabs(p[1] - line) / sqrt(1 + 324 * p[0] * p[0]);

	return fmax(away - 0.0011, fmax(fabs(p[0]) - 0.024, 0.21 - p[2]));
}

void cow_colour(const double p[3], double rgb[3])
{
	memcpy(rgb, white, sizeof(white));
	blend_colour(rgb, brown, share_inside(coat_patches(p), EDGE));
	if (cow_head(p) > 0.005)
		blend_colour(rgb, brown, share_inside(cow_ears(p) - 0.002, EDGE));
	blend_colour(rgb, pink, share_inside(cow_ear_hollows(p) - 0.0008, EDGE));
	blend_colour(rgb, pink, share_inside(cow_udder(p) - 0.0025, 2 * EDGE));
	blend_colour(rgb, pink, share_inside(cow_muzzle(p) - 0.0022, 2 * EDGE));
	blend_colour(rgb, rose, share_inside(cow_nostrils(p) - 0.0012, 2 * EDGE));
	blend_colour(rgb, dark, share_inside(cow_nostrils(p) + 0.0015, 2 * EDGE));
	blend_colour(rgb, rose, 0.9 * share_inside(mouth_arc(p), EDGE));
	blend_colour(rgb, cream, share_inside(cow_horns(p) - 0.0012, EDGE));
	blend_colour(rgb, horn_tip, share_inside(fmax(cow_horns(p) - 0.0012, 0.384 - p[1]), 0.006));
	blend_colour(rgb, brown,
		     share_inside(cow_tuft(p) - 0.003 + 0.002 * smooth_noise(p, 0.006), EDGE));
	blend_colour(rgb, dark, share_inside(cow_hooves(p), EDGE));
}
