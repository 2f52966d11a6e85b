/* SPDX-License-Identifier: MIT */
/* How a part's values become 8-bit levels under each cell and sky, and what error each value may
 * have. Private to the encoder. */
#ifndef INLAY_BAKE_ENCODE_ENCODE_EXPOSE_H
#define INLAY_BAKE_ENCODE_ENCODE_EXPOSE_H

#include "bake/encode/encode_part.h"

/* The 8-bit level, not rounded, of linear light 0..1, by linear interpolation: off by less than
 * LEVELS_ERROR. And how far light may rise or fall until it is off by the error asked for under a
 * cell, as if nothing were clipped: what is clipped alone is not when lights add up. */
#define LEVELS_STEPS 16384
#define LEVELS_ERROR 0.001
struct levels {
	float at[LEVELS_STEPS + 2];
	float rise[LEVELS_STEPS + 2], fall[LEVELS_STEPS + 2];
};

void levels_fill(struct levels *levels, double cell_error);

static inline float levels_read(const float *table, float x)
{
	const float clipped = x < 0 ? 0 : x > 1 ? 1 : x;
	const float place = clipped * LEVELS_STEPS;
	const int step = (int)place;

	return table[step] + (place - (float)step) * (table[step + 1] - table[step]);
}

static inline float level_of(const struct levels *levels, float x)
{
	return levels_read(levels->at, x);
}

/* Of the darkest light, the steepest: no two levels are farther apart than this times their light.
 */
#define LEVELS_STEEPEST (12.92F * 255)

/* The largest of values times sign, 1 or -1; 0 where none is above 0. */
float part_largest(const float *value, int count, float sign);

/* After loading (and pairing), and again when the ensemble has changed: exposures. */
void part_expose(struct part *part, const struct encode_settings *settings);

/* After that, and again when shares have changed: what may be left of each value, which pixels are
 * worth keeping, and how lights and pixels count. tolerance in levels. */
void part_limit(struct part *part, const struct encode_settings *settings,
		const struct levels *levels, double tolerance);

/* Whether this may be left [rows] out of a light's values: no pixel is off by more than the error
 * asked for under this cell alone. */
bool part_cell_holds(const struct part *part, int light, const float *left);

/* The same of a channel's pixels from..to - 1. */
bool part_pixels_hold(const struct part *part, int light, int channel, int from, int to,
		      const float *left);

/*
 * How far a column that makes up for left [rows] has to reach at least (scale times the largest
 * value that is stored): frames leave it out where X times that is below the cut, and as their
 * light fades, no pixel may be off by more than the error asked for at the moment when that
 * happens. Farther, where lights by themselves may do with less. 0: however far.
 */
double part_column_reach(const struct part *part, int light, const float *left);

/* The largest share that any pixel of the blocks takes up of what may be left of a light's values.
 */
float part_cell_share(const struct part *part, int light, const float *left);

#endif
