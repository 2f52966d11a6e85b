/* SPDX-License-Identifier: MIT */
/*
 * Estimates the noise of a tile: the standard error of its picture under the suns of the ensemble
 * (bake/judge/ensemble.h), as the RMS over these, over channels and over the pixels that the object
 * changes, in 8-bit sRGB levels. White level ground is 1 in the picture, brighter light is
 * clipped, and the scene's ground is the background.
 *
 * Samples lie evenly (Sobol), so the error of their mean is smaller than that of independent
 * samples, and smaller than the differences between runs of samples suggest. It is estimated from
 * how these differences fall with the length of the runs. With V(n) = n times the variance of the
 * mean of n samples, the expected values are
 *
 *     D(n) = n / 2 (mean of a run - mean of the next)^2 = 2 V(n) - V(2 n)
 *     V(2 n) = q V(n):   D(n) = (2 - q) V(n),   q = D(2 n) / D(n)
 *
 * where the errors of the two runs are negatively correlated, as they are two halves of one net.
 *
 * This holds for light that is not filtered. Bounced light of the sun's cell is filtered; its noise
 * is that of the filter's result (bake/trace/bounce.h). The rest of bounced light comes from an
 * even sky, and the filter does not change it.
 */
#ifndef INLAY_BAKE_TILES_TILE_NOISE_H
#define INLAY_BAKE_TILES_TILE_NOISE_H

#include "bake/tiles/tile.h"

#define TILE_NOISE_BLOCKS 8 /* samples are summed in at most this many runs */

/* The picture in one channel under one sun. */
struct tile_noise_value {
	/* Sums over the samples of each run: of all light, and of all but the sun's bounced
	 * light. */
	float all[TILE_NOISE_BLOCKS], rest[TILE_NOISE_BLOCKS];
	float filtered[2]; /* the sun's bounced light as filtered, and an example of its noise */
};

struct tile_noise {
	/* Number of runs begun, of batches in the last of them, and of batches in a whole run. */
	int blocks, batches, batches_each;
	double samples[TILE_NOISE_BLOCKS]; /* number of samples of each run */
	/* Sums up to the batch before: rows under each sun, and weights of the background. */
	float before[TILE_PIXELS][3][ENSEMBLE_SUNS][TILE_KINDS][2];
	double before_weight[TILE_PIXELS][6];
	struct tile_noise_value value[TILE_PIXELS][3][ENSEMBLE_SUNS];
	bool filtered;
	/* The result: the sum of squared standard errors, and their number. */
	double square;
	long count;
};

/* -ENOMEM */
int tile_noise_create(struct tile *tile);

/* Begins a tile. */
void tile_noise_clear(struct tile *tile);

/* Begins a batch of `samples` samples a pixel. */
void tile_noise_begin(struct tile *tile, int samples);

/* Adds the last batch of pixel `at`. */
void tile_noise_add(struct tile *tile, int at);

/* Adds a kind's filtered bounced light, and the noise that the filter leaves in it. */
void tile_noise_filtered(struct tile *tile, enum tile_kind kind, const uint16_t *pixel, int pixels);

/* Tells whether the runs are whole, and four, six or eight: the noise may be judged, and the bake
 * may end here. */
bool tile_noise_ready(const struct tile *tile);

/* Sets square and count. Returns the RMS standard error in 8-bit levels, or 0 if it is not
 * known. */
double tile_noise_judge(struct tile *tile);

#endif
