/* SPDX-License-Identifier: MIT */
/* Exposure: how a part's values become 8-bit levels under each cell and sky, and how far light may
 * rise and fall until it is off by the error asked for. Private to the encoder. */
#ifndef INLAY_BAKE_JUDGE_EXPOSE_H
#define INLAY_BAKE_JUDGE_EXPOSE_H

#include "bake/judge/part.h"

/*
 * Tables over linear light 0..1, read by linear interpolation. `at` is the 8-bit level, not
 * rounded, with an error below LEVELS_ERROR. Light may rise by `rise`, or fall by `fall`, until its
 * level is off by the error asked for under a cell. Clipping is ignored, as light that is clipped
 * under one cell need not be clipped where lights add up.
 */
#define LEVELS_STEPS 16384
#define LEVELS_ERROR 0.001
struct levels {
	float at[LEVELS_STEPS + 2];
	float rise[LEVELS_STEPS + 2], fall[LEVELS_STEPS + 2];
};

/* Fills the tables for an error asked for under a cell, in levels. */
void levels_fill(struct levels *levels, double cell_error);

static inline float levels_read(const float *table, float x)
{
	const float place = smaller(larger(x, 0), 1) * LEVELS_STEPS;
	const int step = (int)place;

	return table[step] + (place - (float)step) * (table[step + 1] - table[step]);
}

static inline float levels_at(const struct levels *levels, float x)
{
	return levels_read(levels->at, x);
}

/* Computes the exposures of a tile's parts, and their sums under all skies. The parts must be
 * loaded, and paired. */
void parts_expose(struct part *parts, int count, const struct encode_settings *settings);

#endif
