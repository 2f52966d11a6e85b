/* SPDX-License-Identifier: MIT */
/* Exposure: how a part's values become 8-bit levels under each cell and sky, and the error that
 * each value may have. Private to the encoder. */
#ifndef INLAY_BAKE_JUDGE_EXPOSE_H
#define INLAY_BAKE_JUDGE_EXPOSE_H

#include "bake/judge/part.h"

/*
 * Tables over linear light 0..1, read by linear interpolation. `at` is the 8-bit level, not
 * rounded, with an error below LEVELS_ERROR. `rise` and `fall` are how far light may rise or fall
 * until its level is off by the error asked for under a cell. They do not take clipping into
 * account, as light that is clipped under one cell is not clipped where lights add up.
 */
#define LEVELS_STEPS 16384
#define LEVELS_ERROR 0.001
struct levels {
	float at[LEVELS_STEPS + 2];
	float rise[LEVELS_STEPS + 2], fall[LEVELS_STEPS + 2];
};

/* cell_error: error asked for under a cell, in levels. */
void levels_fill(struct levels *levels, double cell_error);

static inline float levels_read(const float *table, float x)
{
	const float clipped = x < 0 ? 0 : x > 1 ? 1 : x;
	const float place = clipped * LEVELS_STEPS;
	const int step = (int)place;

	return table[step] + (place - (float)step) * (table[step + 1] - table[step]);
}

static inline float levels_at(const struct levels *levels, float x)
{
	return levels_read(levels->at, x);
}

/* Sets the exposures of a tile's parts, after loading (and pairing), and the sums under all skies. */
void parts_expose(struct part *parts, int count, const struct encode_settings *settings);

#endif
