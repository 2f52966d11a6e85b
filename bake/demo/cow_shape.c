/* SPDX-License-Identifier: MIT */
#include "bake/demo/cow_shape.h"

#include <stdbool.h>
#include <stddef.h>

#include "hal/optics/vec.h"

#define COUNT(array) (sizeof(array) / sizeof(*(array)))
/* Width of a join where equal radii meet, which needs no fillet. */
#define JOINT 0.002
#define BELL_RIM 0.154

/* Paired features are written for the left side, and mirrored. */
static struct ellipsoid mirrored_ellipsoid(const struct ellipsoid *left, int side)
{
	struct ellipsoid out = *left;

	if (side) {
		out.centre[0] = -out.centre[0];
		out.turn_deg[1] = -out.turn_deg[1];
		out.turn_deg[2] = -out.turn_deg[2];
	}
	return out;
}

static struct round_cone mirrored_cone(const struct round_cone *left, int side)
{
	struct round_cone out = *left;

	if (side) {
		out.end[0][0] = -out.end[0][0];
		out.end[1][0] = -out.end[1][0];
	}
	return out;
}

static const struct ellipsoid trunk[] = {
	{.centre = {0, 0.176, -0.022}, .radius = {0.083, 0.079, 0.112}},
	{.centre = {0, 0.181, 0.052}, .radius = {0.069, 0.072, 0.062}},
	{.centre = {0, 0.186, -0.092}, .radius = {0.072, 0.068, 0.058}},
};
static const struct round_cone neck = {{{0, 0.208, 0.078}, {0, 0.272, 0.132}}, {0.055, 0.047}};
static const struct ellipsoid skull = {.centre = {0, 0.301, 0.152},
				       .radius = {0.060, 0.057, 0.060}};
static const struct ellipsoid muzzle = {
	.centre = {0, 0.272, 0.204}, .radius = {0.0455, 0.0335, 0.0345}, .turn_deg = {8, 0, 0}};
static const struct ellipsoid nostril = {.centre = {0.0165, 0.281, 0.2365},
					 .radius = {0.0052, 0.0070, 0.0060},
					 .turn_deg = {0, 0, -22}};
static const struct round_cone leg[2] = {
	{{{0.043, 0.135, 0.066}, {0.047, 0.02, 0.070}}, {0.035, 0.0265}},
	{{{0.042, 0.140, -0.090}, {0.047, 0.02, -0.098}}, {0.039, 0.0265}},
};
static const struct round_cone hoof[2] = {
	{{{0.047, 0.020, 0.0710}, {0.0475, -0.02, 0.0730}}, {0.0275, 0.0335}},
	{{{0.047, 0.020, -0.0970}, {0.0475, -0.02, -0.0950}}, {0.0275, 0.0335}},
};
static const struct round_cone horn[] = {
	{{{0.026, 0.343, 0.150}, {0.038, 0.359, 0.149}}, {0.0125, 0.0106}},
	{{{0.038, 0.359, 0.149}, {0.0445, 0.374, 0.150}}, {0.0106, 0.0085}},
	{{{0.0445, 0.374, 0.150}, {0.0455, 0.391, 0.154}}, {0.0085, 0.0050}},
};
static const struct ellipsoid ear = {.centre = {0.083, 0.322, 0.137},
				     .radius = {0.036, 0.0185, 0.0100},
				     .turn_deg = {-10, 12, -14}};
static const struct ellipsoid ear_hollow = {.centre = {0.0865, 0.3205, 0.1475},
					    .radius = {0.0270, 0.0120, 0.0085},
					    .turn_deg = {-10, 12, -14}};
static const struct ellipsoid udder = {.centre = {0, 0.108, -0.052},
				       .radius = {0.036, 0.026, 0.036}};
static const struct round_cone teat[2] = {
	{{{0.014, 0.092, -0.038}, {0.016, 0.079, -0.037}}, {0.0075, 0.0055}},
	{{{0.014, 0.092, -0.064}, {0.016, 0.079, -0.065}}, {0.0075, 0.0055}},
};
static const struct round_cone tail[] = {
	{{{0, 0.222, -0.136}, {0.004, 0.222, -0.160}}, {0.0100, 0.0078}},
	{{{0.004, 0.222, -0.160}, {0.012, 0.196, -0.172}}, {0.0078, 0.0070}},
	{{{0.012, 0.196, -0.172}, {0.020, 0.150, -0.172}}, {0.0070, 0.0064}},
};
static const struct ellipsoid tuft = {.centre = {0.0235, 0.126, -0.173},
				      .radius = {0.0125, 0.029, 0.0125},
				      .turn_deg = {4, 0, 8}};
static const struct ellipsoid eye = {.centre = {0.0365, 0.3125, 0.1960},
				     .radius = {0.0132, 0.0158, 0.0132}};
static const struct ring collar = {.centre = {0, 0.240, 0.107},
				   .radius = {0.0545, 0.0575},
				   .tube = {0.0052, 0.0085},
				   .tilt_deg = 38};
static const struct round_cone bell = {{{0, 0.184, 0.1625}, {0, 0.166, 0.1645}}, {0.0125, 0.0180}};
static const struct round_cone bell_eyelet = {{{0, 0.197, 0.161}, {0, 0.203, 0.160}},
					      {0.0055, 0.0055}};
static const struct ellipsoid bell_clapper = {.centre = {0, 0.1535, 0.1655},
					      .radius = {0.0065, 0.0065, 0.0065}};

static struct implicit one_leg(int k, int side, const double p[3])
{
	const struct round_cone shin = mirrored_cone(&leg[k], side);
	const struct round_cone shoe = mirrored_cone(&hoof[k], side);

	return implicit_union(implicit_round_cone(&shin, p), implicit_round_cone(&shoe, p), 0.006);
}

static struct implicit horns_solid(const double p[3])
{
	struct implicit f = {.value = 1};

	for (int side = 0; side < 2; side++) {
		for (size_t k = 0; k < COUNT(horn); k++) {
			const struct round_cone c = mirrored_cone(&horn[k], side);

			f = implicit_union(f, implicit_round_cone(&c, p), JOINT);
		}
	}
	return f;
}

static struct implicit tail_and_tuft(const double p[3])
{
	struct implicit f = implicit_round_cone(&tail[0], p);

	for (size_t k = 1; k < COUNT(tail); k++)
		f = implicit_union(f, implicit_round_cone(&tail[k], p), JOINT);
	return implicit_union(f, implicit_ellipsoid(&tuft, p), 0.010);
}

static struct implicit ears_solid(const double p[3])
{
	struct implicit f = {.value = 1};

	for (int side = 0; side < 2; side++) {
		const struct ellipsoid shell = mirrored_ellipsoid(&ear, side);
		const struct ellipsoid hollow = mirrored_ellipsoid(&ear_hollow, side);

		f = implicit_union(f,
				   implicit_difference(implicit_ellipsoid(&shell, p),
						       implicit_ellipsoid(&hollow, p), 0.005),
				   0.004);
	}
	return f;
}

static struct implicit head_solid(const double p[3])
{
	struct implicit f = implicit_ellipsoid(&skull, p);

	f = implicit_union(f, implicit_ellipsoid(&muzzle, p), 0.024);
	for (int side = 0; side < 2; side++) {
		const struct ellipsoid hole = mirrored_ellipsoid(&nostril, side);

		f = implicit_difference(f, implicit_ellipsoid(&hole, p), 0.005);
	}
	return f;
}

static struct implicit udder_solid(const double p[3])
{
	struct implicit f = implicit_ellipsoid(&udder, p);

	for (int side = 0; side < 2; side++) {
		for (size_t k = 0; k < COUNT(teat); k++) {
			const struct round_cone c = mirrored_cone(&teat[k], side);

			f = implicit_union(f, implicit_round_cone(&c, p), 0.008);
		}
	}
	return f;
}

/* Whether p is within reach of a feature, its join included. Others need not be evaluated. */
static bool is_near(const double p[3], double x, double y, double z, double reach)
{
	const double away[3] = {p[0] - x, p[1] - y, p[2] - z};

	return vec_dot(away, away) < reach * reach;
}

static struct implicit coat_at(const void *context, const double p[3])
{
	struct implicit f = implicit_ellipsoid(&trunk[0], p);

	(void)context;
	for (size_t k = 1; k < COUNT(trunk); k++)
		f = implicit_union(f, implicit_ellipsoid(&trunk[k], p), 0.05);
	f = implicit_union(f, implicit_round_cone(&neck, p), 0.04);
	for (int k = 0; k < 4; k++)
		f = implicit_union(f, one_leg(k / 2, k % 2, p), 0.034);
	if (is_near(p, 0, 0.315, 0.160, 0.170)) {
		f = implicit_union(f, head_solid(p), 0.03);
		f = implicit_union(f, horns_solid(p), 0.007);
		f = implicit_union(f, ears_solid(p), 0.016);
	}
	if (is_near(p, 0, 0.100, -0.052, 0.080))
		f = implicit_union(f, udder_solid(p), 0.016);
	if (is_near(p, 0.012, 0.160, -0.160, 0.110))
		f = implicit_union(f, tail_and_tuft(p), 0.010);
	return implicit_intersection(f, implicit_above(0, p), 0.008);
}

static struct implicit eye_at(const void *context, const double p[3])
{
	const struct ellipsoid ball = mirrored_ellipsoid(&eye, *(const int *)context);

	return implicit_ellipsoid(&ball, p);
}

static struct implicit collar_at(const void *context, const double p[3])
{
	(void)context;
	return implicit_ring(&collar, p);
}

static struct implicit bell_at(const void *context, const double p[3])
{
	struct implicit f = implicit_round_cone(&bell, p);

	(void)context;
	f = implicit_intersection(f, implicit_above(BELL_RIM, p), 0.005);
	f = implicit_union(f, implicit_round_cone(&bell_eyelet, p), 0.004);
	return implicit_union(f, implicit_ellipsoid(&bell_clapper, p), 0.004);
}

static const int left = 0, right = 1;

const struct cow_part cow_parts[COW_PARTS] = {
	{"body", "coat", {coat_at, NULL, {-0.13, 0, -0.20}, {0.13, 0.41, 0.25}}, 0.0042},
	{"eye-left", "eye", {eye_at, &left, {0.02, 0.29, 0.18}, {0.055, 0.33, 0.215}}, 0.0020},
	{"eye-right", "eye", {eye_at, &right, {-0.055, 0.29, 0.18}, {-0.02, 0.33, 0.215}}, 0.0020},
	{"collar", "collar", {collar_at, NULL, {-0.07, 0.18, 0.04}, {0.07, 0.30, 0.18}}, 0.0030},
	{"bell", "bell", {bell_at, NULL, {-0.025, 0.14, 0.14}, {0.025, 0.215, 0.19}}, 0.0020},
};

static double least_of_pair(const struct ellipsoid *shape, const double p[3])
{
	double least = 1;

	for (int side = 0; side < 2; side++) {
		const struct ellipsoid one = mirrored_ellipsoid(shape, side);

		least = fmin(least, implicit_ellipsoid(&one, p).value);
	}
	return least;
}

double cow_muzzle(const double p[3])
{
	return implicit_ellipsoid(&muzzle, p).value;
}

double cow_udder(const double p[3])
{
	return udder_solid(p).value;
}

double cow_horns(const double p[3])
{
	return horns_solid(p).value;
}

double cow_ears(const double p[3])
{
	return ears_solid(p).value;
}

double cow_ear_hollows(const double p[3])
{
	return least_of_pair(&ear_hollow, p);
}

double cow_tuft(const double p[3])
{
	return implicit_ellipsoid(&tuft, p).value;
}

double cow_head(const double p[3])
{
	return implicit_ellipsoid(&skull, p).value;
}

double cow_nostrils(const double p[3])
{
	return least_of_pair(&nostril, p);
}

double cow_hooves(const double p[3])
{
	return p[1] - 0.0235;
}
