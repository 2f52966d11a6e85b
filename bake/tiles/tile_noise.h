/* SPDX-License-Identifier: MIT */
/*
 * Estimates the noise of a tile: the standard error of its picture under the suns of the ensemble
 * (bake/judge/ensemble.h), as the RMS over these, over channels and over the pixels that the object
 * changes, in 8-bit sRGB levels. White level ground is 1 in the picture, what is brighter is
 * clipped, and the scene's ground is the background.
 *
 * Samples lie evenly (Sobol), so that a mean of many is nearer than one of independent samples, and
 * nearer than the differences between runs of samples say. How these fall with the length of the
 * runs tells by how much. With V(n) the variance of the mean of n samples, times n,
 *
 *     D(n) = n / 2 (mean of a run - mean of the next)^2 = 2 V(n) - V(2 n)    expected, as what the
 *                              next digit of a net parts has opposite signs in both runs
 *     V(2 n) = q V(n):   D(n) = (2 - q) V(n),   q = D(2 n) / D(n)
 *
 * This holds as long as bounced light is not filtered. Where it is, the noise of the sun's part is
 * that of the filter's result (bake/trace/bounce.h). The rest of bounced light is an even sky's,
 * which the filter does not change.
 */
#ifndef INLAY_BAKE_TILES_TILE_NOISE_H
#define INLAY_BAKE_TILES_TILE_NOISE_H

#include "bake/tiles/tile.h"

#define TILE_NOISE_BLOCKS 8 /* runs of samples that are told apart */

/* The picture in one channel under one sun, summed over the samples of each run: all light, and
 * without what the sun gives of bounced light; the latter when filtered, and an example of its
 * noise. */
struct tile_noise_value {
	float all[TILE_NOISE_BLOCKS], rest[TILE_NOISE_BLOCKS];
	float filtered[2];
};

struct tile_noise {
	/* Runs begun, batches in the last of them, and in a whole one. */
	int blocks, batches, batches_each;
	double samples[TILE_NOISE_BLOCKS]; /* of each run */
	/* Sums up to the last batch: rows under each sun, and weights of the background. */
	float before[TILE_PIXELS][3][ENSEMBLE_SUNS][TILE_KINDS][2];
	double before_weight[TILE_PIXELS][6];
	struct tile_noise_value value[TILE_PIXELS][3][ENSEMBLE_SUNS];
	bool filtered;
	/* The result: sum of squared standard errors, and how many there are. */
	double square;
	long count;
};

/* -ENOMEM */
int tile_noise_create(struct tile *tile);

/* Begins a tile. */
void tile_noise_clear(struct tile *tile);

/* Begins a batch of so many samples a pixel. */
void tile_noise_begin(struct tile *tile, int samples);

/* Takes in the last batch of pixel `at`. */
void tile_noise_add(struct tile *tile, int at);

/* Takes in the noise that the filter leaves in a kind's bounced light. */
void tile_noise_filtered(struct tile *tile, enum tile_kind kind, const uint16_t *pixel, int pixels);

/* Whether the runs are whole, and their number one of which a mean is about as good as that of all
 * samples can be. */
bool tile_noise_ready(const struct tile *tile);

/* Sets square and count. Returns the RMS standard error in 8-bit levels; 0: not known. */
double tile_noise_judge(struct tile *tile);

#endif
