/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/response/light_response.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define EDGE 0.1

static double warp(double u)
{
	return log((EDGE + u) / (EDGE + 1 - u));
}

static double warp_slope(double u)
{
	return 1 / (EDGE + u) + 1 / (EDGE + 1 - u);
}

int light_spline_count(const struct light_spline *spline)
{
	return spline->pieces + 3;
}

/* The four uniform cubic B-splines that are not 0 within a piece, t = 0..1 in it, with first and
 * second derivatives. */
static void pieces_at(double t, double b[4], double slope[4], double bend[4])
{
	const double s = 1 - t;

	b[0] = s * s * s / 6;
	b[1] = (3 * t * t * t - 6 * t * t + 4) / 6;
	b[2] = (3 * s * s * s - 6 * s * s + 4) / 6;
	b[3] = t * t * t / 6;
	slope[0] = -s * s / 2;
	slope[1] = (3 * t * t - 4 * t) / 2;
	slope[2] = -(3 * s * s - 4 * s) / 2;
	slope[3] = t * t / 2;
	bend[0] = s;
	bend[1] = 3 * t - 2;
	bend[2] = 3 * s - 2;
	bend[3] = t;
}

void light_spline_at(const struct light_spline *spline, double u, double *value, double *slope)
{
	const double start = warp(spline->from);
	const double width = (warp(spline->to) - start) / spline->pieces;
	const double x = (warp(u) - start) / width;
	const int piece = (int)fmin(fmax(floor(x), 0), spline->pieces - 1);
	const double t = fmin(fmax(x - piece, 0), 1), beyond = x - piece - t;
	const double bends = fmax(beyond, 0);
	double b[4], db[4], ddb[4];

	pieces_at(t, b, db, ddb);
	memset(value, 0, (size_t)light_spline_count(spline) * sizeof(*value));
	if (slope)
		memset(slope, 0, (size_t)light_spline_count(spline) * sizeof(*slope));
	for (int k = 0; k < 4; k++) {
		value[piece + k] = b[k] + beyond * db[k] + bends * bends / 2 * ddb[k];
		if (slope)
			slope[piece + k] = (db[k] + bends * ddb[k]) * warp_slope(u) / width;
	}
}
