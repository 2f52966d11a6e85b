/* SPDX-License-Identifier: MIT */
/*
 * Low-rank filter against noise in bounced light, the light that met several surfaces.
 *
 * Each sample of bounced light follows one random path, so its noise differs in every pixel and
 * light, while the light itself is smooth. A tile's matrix of pixels by lights is therefore a
 * low-rank matrix plus noise. It comes as two halves of independent samples: what the leading
 * singular vectors of one half find again in the other half is light, the rest is noise.
 *
 * The filter keeps two things exactly. One is each row's sum under a uniform sky, as there blocked
 * and bounced light balance in each sample. The other is the mean over all pixels, for each light
 * and channel. The slope over the pixels is filtered apart from the rest, as an error in it would
 * show as a step between tiles, each of which is filtered by itself.
 */
#ifndef INLAY_BAKE_TRACE_BOUNCE_H
#define INLAY_BAKE_TRACE_BOUNCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define BOUNCE_ROWS_MAX 768 /* rows of a tile: 256 pixels of 3 channels */
#define BOUNCE_RANK_MAX 48

/* Working memory of one thread. */
struct bounce {
	int lights;
	float *memory;
};

/* The filter's input. No value of sky or scale is 0. */
struct bounce_halves {
	int rows;	       /* three channels of each pixel */
	const uint16_t *pixel; /* [rows / 3]: y * BASIS_TILE + x, all different */
	float *half[2];	       /* [rows][lights]: means, each over its own half of the samples */
	double share[2];       /* each half's share of the samples; they sum to 1 */
	const float *sky;      /* [lights]: uniform sky, per value; row sums under it stay */
	const float *scale; /* [lights]: factor that makes the noise of all columns about equal */
};

/* -ENOMEM */
int bounce_create(struct bounce *bounce, int lights);
void bounce_free(struct bounce *bounce); /* idempotent; zeroed is fine */

/*
 * half[0] becomes the filtered mean of both, half[1] an example of its noise: the difference of the
 * filtered halves, scaled to the standard error. Returns the number of singular vectors kept
 * besides sums and means, or -1 if the mean is not filtered, as the halves do not show that the
 * filter would remove more noise than light.
 */
int bounce_filter(struct bounce *bounce, const struct bounce_halves *halves);

/*
 * The parts of bounced light that the filter subtracts before it looks for singular vectors, and
 * adds again afterwards: each row's sum under a uniform sky, and each light's plane over the tile.
 * Private to the filter.
 */

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
