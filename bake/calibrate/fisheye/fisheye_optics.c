/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/fisheye/fisheye_optics.h"

#include <math.h>
#include <string.h>

const char *const optics_names[OPTICS_COUNT] = {"focal x", "focal y", "centre x", "centre y",
						"k1",	   "k2",      "k3",	  "k4"};

struct fisheye_curve optics_curve(const struct optics *optics)
{
	struct fisheye_curve curve = {.model = optics->model};

	memcpy(curve.k, optics->number + OPTICS_TERMS, sizeof(curve.k));
	return curve;
}

/* Intermediate results of a projection: px = centre + focal * shown * (x, y). */
struct optics_sight {
	double theta, radius, slope;
	double across, length2;
	double shown; /* radius / across */
};

/* An orthographic lens shows nothing beyond 90 degrees. A descent that stopped there would end at
 * the first point that reaches the rim; therefore r = sin(theta) is continued a little. */
#define ORTHOGRAPHIC_MOST (95 * M_PI / 180)

static bool is_shown(const struct optics *optics, const struct optics_sight *s)
{
	return s->slope > 0 ||
	       (optics->model == FISHEYE_ORTHOGRAPHIC && s->theta < ORTHOGRAPHIC_MOST);
}

static bool sight_of_point(const struct optics *optics, const double p[3], struct optics_sight *s)
{
	const struct fisheye_curve curve = optics_curve(optics);

	s->across = hypot(p[0], p[1]);
	s->length2 = s->across * s->across + p[2] * p[2];
	s->theta = atan2(s->across, p[2]);
	s->radius = fisheye_curve_radius(&curve, s->theta);
	s->slope = fisheye_curve_slope(&curve, s->theta);
	s->shown = s->across > 0 ? s->radius / s->across : 1 / p[2];
	return s->length2 > 0 && is_shown(optics, s) && s->radius < INFINITY &&
	       s->shown < INFINITY && (s->across > 0 || p[2] > 0);
}

static void differentiate_by_number(const struct optics *optics, const double p[3],
				    const struct optics_sight *s, double (*by)[2])
{
	const double *focal = optics->number + OPTICS_FOCAL;
	double power = s->across > 0 ? s->theta * s->theta * s->theta / s->across : 0;

	memset(by, 0, OPTICS_COUNT * sizeof(*by));
	for (int i = 0; i < 2; i++) {
		by[OPTICS_FOCAL + i][i] = s->shown * p[i];
		by[OPTICS_CENTRE + i][i] = 1;
	}
	for (int k = 0; k < FISHEYE_TERMS; k++) {
		for (int i = 0; i < 2; i++)
			by[OPTICS_TERMS + k][i] = focal[i] * p[i] * power;
		power *= s->theta * s->theta;
	}
}

static void differentiate_by_point(const struct optics *optics, const double p[3],
				   const struct optics_sight *s, double (*by)[2])
{
	const double *focal = optics->number + OPTICS_FOCAL;
	/* d shown / d x = x * bend; on the axis it does not matter */
	const double bend = s->theta > 1e-5 ? (s->slope * p[2] / s->length2 - s->shown) /
						      (s->across * s->across)
					    : 0;

	for (int i = 0; i < 2; i++) {
		for (int k = 0; k < 2; k++)
			by[k][i] = focal[i] * ((i == k ? s->shown : 0) + p[i] * p[k] * bend);
		by[2][i] = -focal[i] * p[i] * s->slope / s->length2;
	}
}

bool optics_project(const struct optics *optics, const double point[3], double px[2],
		    double (*by_number)[2], double (*by_point)[2])
{
	const double *n = optics->number;
	struct optics_sight s;

	if (!(n[OPTICS_FOCAL] > 0 && n[OPTICS_FOCAL + 1] > 0) || !sight_of_point(optics, point, &s))
		return false;
	for (int i = 0; i < 2; i++)
		px[i] = n[OPTICS_CENTRE + i] + n[OPTICS_FOCAL + i] * s.shown * point[i];
	if (by_number)
		differentiate_by_number(optics, point, &s, by_number);
	if (by_point)
		differentiate_by_point(optics, point, &s, by_point);
	return true;
}

bool optics_ray(const struct optics *optics, const double px[2], double ray[3])
{
	const struct fisheye_curve curve = optics_curve(optics);
	const double *n = optics->number;
	const double end = optics->model == FISHEYE_ORTHOGRAPHIC ? M_PI / 2 : M_PI;
	const double most = fmin(fisheye_curve_fold(&curve, end), end);
	double at[2], radius, theta, across;

	for (int i = 0; i < 2; i++)
		at[i] = (px[i] - n[OPTICS_CENTRE + i]) / n[OPTICS_FOCAL + i];
	radius = hypot(at[0], at[1]);
	if (!(radius <= fisheye_curve_radius(&curve, most)))
		return false;
	theta = fisheye_curve_angle(&curve, radius, most);
	across = radius > 1e-8 ? sin(theta) / radius : 1;
	ray[0] = at[0] * across;
	ray[1] = at[1] * across;
	ray[2] = cos(theta);
	return true;
}
