/* SPDX-License-Identifier: MIT */
/*
 * What the filter of bounced light sets aside before it looks for singular vectors, and puts back:
 * each row's sum under a uniform sky, and each light's plane over the tile. Private to the filter.
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
	double sum[BOUNCE_ROWS_MAX][2];		       /* of each half's rows under the sky */
	float *profile;				       /* [lights]: what a sum of 1 looks like */
	int planes;				       /* that the pixels tell apart */
	float plane[BOUNCE_PLANES][BOUNCE_PIXELS_MAX]; /* orthonormal */
	float weight[BOUNCE_PLANES];		       /* what is kept of each */
	float *column[2];			       /* of halves: [planes][channels][lights] */
};

/* Floats of memory that it takes, and where they are. */
size_t bounce_aside_floats(size_t lights);
void bounce_aside_open(struct bounce_aside *aside, size_t lights, float *memory);

/*
 * Both halves become the rest, scaled. As far as the halves tell: noise becomes the squared error
 * of their mean as it is, error that of what was set aside. False: there is no light, or it is not
 * finite; the halves are as they were.
 */
bool bounce_set_aside(struct bounce_aside *aside, const struct bounce_halves *halves, double *noise,
		      double *error);

/* half[0], which is the mean of both rests, becomes that of both halves; filtered: slopes as far as
 * they are known, else as they came. */
void bounce_put_back(struct bounce_aside *aside, const struct bounce_halves *halves, bool filtered);

static inline double bounce_dot(const float *a, const float *b, size_t count)
{
	double sum = 0;

	for (size_t i = 0; i < count; i++)
		sum += (double)a[i] * (double)b[i];
	return sum;
}

#endif
