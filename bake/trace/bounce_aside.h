/* SPDX-License-Identifier: MIT */
/*
 * The parts of bounced light that the filter subtracts before it looks for singular vectors, and
 * adds again afterwards: each row's sum under a uniform sky, and each light's plane over the tile.
 * Private to the filter.
 */
#ifndef INLAY_BAKE_TRACE_BOUNCE_ASIDE_H
#define INLAY_BAKE_TRACE_BOUNCE_ASIDE_H

#include <stdbool.h>
#include <stddef.h>

#include "bake/trace/bounce.h"

#define BOUNCE_CHANNELS 3
#define BOUNCE_PIXELS_MAX (BOUNCE_ROWS_MAX / BOUNCE_CHANNELS)
#define BOUNCE_PLANES 3 /* 1, x, y */

struct bounce_aside {
	size_t lights;
	double sum[BOUNCE_ROWS_MAX][2]; /* each row's sum under the sky, by half */
	float *profile;			/* [lights]: a row of sum 1 */
	int planes;			/* number of planes that are linearly independent */
	float plane[BOUNCE_PLANES][BOUNCE_PIXELS_MAX]; /* orthonormal */
	float weight[BOUNCE_PLANES];		       /* share of each that is kept */
	float *column[2];			       /* [planes][channels][lights], by half */
};

/* Returns the number of floats that bounce_aside_open() needs; the caller owns them. */
size_t bounce_aside_floats(size_t lights);
void bounce_aside_open(struct bounce_aside *aside, size_t lights, float *memory);

/*
 * Subtracts sums and planes; both halves become the rest, scaled. *noise becomes the estimated
 * squared error of the unfiltered mean, *error that of the sums and planes. Returns false, and
 * leaves the halves, if there is no light, or it is not finite.
 */
bool bounce_set_aside(struct bounce_aside *aside, const struct bounce_halves *halves, double *noise,
		      double *error);

/* Removes the scale and adds sums and planes to half[0], the mean of both rests, and to half[1],
 * its noise. If `filtered`, slopes have their Wiener weights. */
void bounce_put_back(struct bounce_aside *aside, const struct bounce_halves *halves, bool filtered);

static inline double bounce_dot(const float *a, const float *b, size_t count)
{
	double sum = 0;

	for (size_t i = 0; i < count; i++)
		sum += (double)a[i] * (double)b[i];
	return sum;
}

#endif
