/* SPDX-License-Identifier: MIT */
#include "hal/compositor/steady.h"

#include <math.h>

#include "hal/compositor/column_choice.h"

/* The roundings of a block, in Q24: 2^-17 of its weights, three units of its values (README.md,
 * "Distance from double precision"), and far less than a unit of the doubles here. */
#define ROUNDINGS 132.0

/* Forced inline because gcc 12 drops calls of functions that only prefetch. */
static inline __attribute__((always_inline)) void fetch_patterns(const struct basis_block *b)
{
	for (int k = 0; k < b->patterns * b->stride; k += KERNEL_LINE16)
		fetch_line(b->pattern + k);
}

void steady_fetch(const struct tile_plan *tile)
{
	for (int n = 0; n < tile->block_count; n++)
		fetch_patterns(tile->blocks[n].block);
}

static bool is_within(const double bound[3], int32_t limit)
{
	return bound[0] <= limit && bound[1] <= limit && bound[2] <= limit;
}

/* Adds |light| * reach in Q24, in each channel. */
static void bound_add(double bound[3], const struct light_vector *light, const double amount[3],
		      const float reach[3])
{
	for (int c = 0; c < 3; c++)
		bound[c] += fabs(amount[c]) * (double)reach[c] * (light->factor[c] * 0x1p-6);
}

static void bound_columns(double bound[3], const struct light_vector *light,
			  const struct block_plan *plan)
{
	int count;
	const struct chosen_column *chosen = columns_chosen(plan, &count);

	for (int k = 0; k < count; k++) {
		const float reach = chosen[k].scale * (plan->block->bits == 8 ? 127 : 32767);

		bound_add(bound, light, light->sent[chosen[k].light].amount,
			  (const float[3]){reach, reach, reach});
	}
}

static void bound_patterns(double bound[3], const struct light_vector *light,
			   const struct block_plan *plan, const struct kernels *kernels,
			   struct block_work *work)
{
	const struct basis_block *b = plan->block;

	if (b->patterns)
		kernels->project(b->pattern, b->patterns, b->stride, light->planes, work->y);
	for (int j = 0; j < b->patterns; j++) {
		double y[3];

		for (int c = 0; c < 3; c++)
			y[c] = (double)work->y[j][c] * light->unit[c];
		bound_add(bound, light, y, plan->farthest[j]);
	}
}

/* Sets bound[c] >= |1 - ratio| in Q24 of all values. Returns false where it is above the limit, or
 * not known: all columns are read, or so strong a light leaves few fraction bits. */
static bool tile_bound(const struct frame_light *f, const struct tile_plan *tile, int32_t limit,
		       struct block_work *work, double bound[3])
{
	bound[0] = bound[1] = bound[2] = ROUNDINGS * tile->block_count;
	for (int n = 0; n < tile->block_count && is_within(bound, limit); n++) {
		const struct block_plan *plan = &tile->blocks[n];
		const struct light_vector *light = &f->ground[plan->block->ground];

		if ((plan->block->columns && !plan->choice) ||
		    plan->fraction > PLAN_SUM_BITS - plan->bound - light->reach)
			return false;
		if (plan->choice)
			bound_columns(bound, light, plan);
	}
	for (int n = 0; n < tile->block_count && is_within(bound, limit); n++)
		bound_patterns(bound, &f->ground[tile->blocks[n].block->ground], &tile->blocks[n],
			       f->kernels, work);
	return is_within(bound, limit);
}

/* Replaces codes by larger ones of a row, in whole vectors. */
static void take_larger(uint8_t most[BASIS_TILE * 4], const uint8_t *row)
{
	for (int k = 0; k < BASIS_TILE * 4; k++)
		most[k] = row[k] > most[k] ? row[k] : most[k];
}

bool steady_tile(const struct frame_light *f, const struct tile_plan *tile,
		 const struct kernel_curves *curves, struct backdrop_rows rows, int width,
		 int height, struct block_work *work)
{
	uint8_t most[BASIS_TILE * 4] = {0};
	double bound[3];

	if (!tile_bound(f, tile, curves->steady[0], work, bound))
		return false;
	if (width < BASIS_TILE)
		return is_within(bound, curves->steady[255]);
	for (int y = 0; y < height; y++, rows.pixels += rows.stride)
		take_larger(most, rows.pixels);
	for (int k = 0; k < BASIS_TILE * 4; k++)
		if (k % 4 != 3 && bound[2 - k % 4] > curves->steady[most[k]])
			return false;
	return true;
}
