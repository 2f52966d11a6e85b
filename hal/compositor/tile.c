/* SPDX-License-Identifier: MIT */
#include "hal/compositor/tile.h"

#include <string.h>

#include "hal/compositor/column_choice.h"
#include "hal/compositor/kernels/fixed.h"

/* Fraction bits of O and 1 - ratio. */
#define VALUE_BITS 24
/* Limit for the sum of the magnitudes of a value's parts. Below it, no partial sum, roundings
 * included, overflows int32 or reaches KERNEL_LIMIT. */
#define ORDINARY 63.0

/* How the sums of a group are converted to values. */
struct folding {
	int shift;
	const uint32_t *factor; /* [3] */
};

static const struct light_vector *block_light(const struct frame_light *f,
					      const struct basis_block *b)
{
	switch (b->kind) {
	case BASIS_KIND_T:
		return f->object;
	case BASIS_KIND_V:
		return &f->ground[b->ground];
	case BASIS_KIND_D:
		return f->taken;
	default:
		return f->own;
	}
}

/* Returns the next block that counts, or NULL. */
static const struct block_plan *
block_next(const struct frame_light *f, const struct tile_work *work, const struct block_plan *plan)
{
	do
		plan = plan + 1 == work->end ? work->after : plan + 1;
	while (plan < f->end && !block_counts(plan));
	return plan < f->end ? plan : NULL;
}

static struct block_request request_for(const struct frame_light *f, const struct block_plan *plan,
					bool fresh, const struct tile_work *work)
{
	return (struct block_request){
		.kernels = f->kernels,
		.light = block_light(f, plan->block),
		.fresh = fresh,
		.next = block_next(f, work, plan),
	};
}

static void sum_block(const struct frame_light *f, const struct block_plan *plan, bool fresh,
		      int fraction, struct tile_work *work, const int64_t *sum[3])
{
	const struct block_request request = request_for(f, plan, fresh, work);

	block_sums(&work->block, plan, &request, fraction, sum);
}

/* Shifts sums up, clamped to +-2^62. Extremely strong light has so few fraction bits that its sums
 * must be shifted up instead of down; what is clamped here exceeds every later limit. */
static const int64_t *sums_lifted(const int64_t *sum, int count, int up, int64_t *to)
{
	const int64_t most = up < 62 ? (INT64_C(1) << 62) >> up : 0;

	for (int p = 0; p < count; p++) {
		if (sum[p] > most || sum[p] < -most)
			to[p] = sum[p] > 0 ? INT64_C(1) << 62 : -(INT64_C(1) << 62);
		else
			to[p] = up < 62 ? sum[p] * (INT64_C(1) << up) : 0;
	}
	return to;
}

/* Adds the sums of `count` pixels to their values; fresh: overwrites the values. */
static void sums_fold(const struct frame_light *f, const struct folding *how, int c,
		      const int64_t *sum, int count, const uint16_t *tint, bool fresh,
		      struct tile_work *work, int32_t *values)
{
	const int32_t *from = fresh ? tile_nothing : values;
	const int shift = how->shift >= 1 ? how->shift : 1;

	if (how->shift < 1)
		sum = sums_lifted(sum, count, 1 - how->shift, work->block.sum[c]);
	f->kernels->fold(sum, count, shift, how->factor[c], tint, from, values);
}

/* Adds the sums of blocks that share them; plan is the last of these blocks. */
static void fold_block(const struct frame_light *f, const struct block_plan *plan,
		       const struct folding *how, const int64_t *const sum[3], bool fresh,
		       struct tile_work *work, int32_t (*values)[BLOCK_PIXELS])
{
	const struct basis_block *b = plan->block;

	for (int c = 0; c < 3; c++) {
		const uint16_t *tint = b->tint ? b->tint + c * b->pixels : NULL;

		if (plan->whole) {
			sums_fold(f, how, c, sum[c], b->pixels, tint, fresh, work, values[c]);
			continue;
		}
		if (fresh)
			memset(values[c], 0, sizeof(values[c]));
		sums_fold(f, how, c, sum[c], b->pixels, tint, true, work, work->listed);
		f->kernels->place(work->listed, plan->row, values[c]);
	}
}

static void sums_spread(const struct basis_block *b, const int64_t *const sum[3],
			int64_t (*to)[BLOCK_PIXELS])
{
	for (int c = 0; c < 3; c++) {
		for (int p = 0; p < b->pixels; p++)
			to[c][b->pixel[p]] += b->tint ? mul_q15(sum[c][p],
								b->tint[c * b->pixels + p])
						      : sum[c][p];
	}
}

static bool is_ordinary(const struct block_plan *group, const struct light_vector *light)
{
	return group->most * light->strongest <= ORDINARY;
}

static int group_room(const struct block_plan *group, const struct light_vector *light)
{
	return PLAN_SUM_BITS - group->bound - light->reach;
}

/* ---- few lines in light of ordinary strength: the common case ---- */

/* Whether few lines of a group count: so few that the roundings of their weights, 2^-22 for a line
 * of 16 bits and 2^-24 for one of 8, come to 2^-17 at most. */
static bool group_is_short(const struct block_plan *group)
{
	int lines = 0;

	for (int n = 0; n < group->group; n++) {
		int columns = group[n].block->columns;

		if (group[n].choice)
			columns_chosen(&group[n], &columns);
		lines += 4 * group[n].block->patterns;
		lines += group[n].block->bits == 8 ? columns : 4 * columns;
	}
	return lines <= KERNEL_VALUE_LINES8;
}

static void tint_values(const struct frame_light *f, const struct basis_block *b,
			int32_t *const value[3])
{
	for (int c = 0; c < 3; c++)
		f->kernels->tint(value[c], b->tint + c * b->pixels, b->pixels);
}

/* Adds the values of a block's listed pixels to the tile. */
static void place_values(const struct frame_light *f, const struct block_plan *plan, bool fresh,
			 int32_t *const listed[3], int32_t (*values)[BLOCK_PIXELS])
{
	for (int c = 0; c < 3; c++) {
		if (fresh)
			memset(values[c], 0, sizeof(values[c]));
		f->kernels->place(listed[c], plan->row, values[c]);
	}
}

/* The same as group_add(), with rounded values instead of exact sums. A block of a whole tile
 * writes its values directly to the tile; if it is tinted, only where there are no others. */
static bool group_add_values(const struct frame_light *f, const struct block_plan *group,
			     int fraction, bool fresh, struct tile_work *work,
			     int32_t (*values)[BLOCK_PIXELS])
{
	int32_t *const whole[3] = {values[0], values[1], values[2]};
	int32_t *const listed[3] = {work->listed, work->listed + BLOCK_PIXELS,
				    work->listed + 2 * BLOCK_PIXELS};
	const bool first = fresh; /* else values may be near the limit: clamp */
	bool begun = false;	  /* a block of those that share their values is done */

	for (int n = 0; n < group->group; n++) {
		const struct block_plan *plan = &group[n];
		const uint16_t *tint = plan->block->tint;
		const bool direct = plan->whole && (tint ? fresh : first);

		if (block_counts(plan)) {
			const struct block_request request =
				request_for(f, plan, direct ? fresh : !begun, work);

			block_values(&work->block, plan, &request, fraction,
				     direct ? whole : listed);
			if (tint)
				tint_values(f, plan->block, direct ? whole : listed);
			begun = true;
			fresh = fresh && !direct;
		}
		if (!begun || (n + 1 < group->group && group[n + 1].joins))
			continue;
		begun = false;
		if (!direct) {
			place_values(f, plan, fresh, listed, values);
			fresh = false;
		}
	}
	return fresh;
}

/* ---- groups ---- */

/*
 * Adds a group of T or V blocks to the values; fresh: the values are 0, whatever the memory holds.
 * Returns the new `fresh`, which stays true if no block counts. In very strong light a part of a
 * value might be clamped at the limit of Q24 although another part or a dark tint brings the value
 * back below it. Then the exact sums of all blocks are added up before the conversion.
 */
static bool group_add(const struct frame_light *f, const struct block_plan *group,
		      const struct light_vector *light, int more, bool fresh,
		      struct tile_work *work, int32_t (*values)[BLOCK_PIXELS])
{
	const int wanted = group->fraction + more, most = group_room(group, light);
	const int fraction = wanted < most ? wanted : most;
	const struct folding how = {fraction - VALUE_BITS - more, light->factor};
	const bool ordinary = is_ordinary(group, light), apart = group->single || ordinary;
	const int64_t *sum[3];
	bool summed = false; /* a block of those that share their sums is done */

	if (ordinary && group_is_short(group))
		return group_add_values(f, group, VALUE_BITS + KERNEL_VALUE_SHIFT16 + more, fresh,
					work, values);
	if (!apart)
		memset(work->d, 0, sizeof(work->d));
	for (int n = 0; n < group->group; n++) {
		if (block_counts(&group[n])) {
			sum_block(f, &group[n], !summed, fraction, work, sum);
			summed = true;
		}
		if (!summed || (n + 1 < group->group && group[n + 1].joins))
			continue;
		summed = false;
		if (apart)
			fold_block(f, &group[n], &how, sum, fresh, work, values);
		else
			sums_spread(group[n].block, sum, work->d);
		fresh = fresh && !apart;
	}
	for (int c = 0; c < 3 && !apart; c++)
		sums_fold(f, &how, c, work->d[c], BLOCK_PIXELS, NULL, fresh, work, values[c]);
	return fresh && apart;
}

/* ---- receivers with a u of their own ---- */

static int receiver_sums(const struct frame_light *f, const struct block_plan *group,
			 const struct light_vector *light, struct tile_work *work,
			 int64_t (*to)[BLOCK_PIXELS])
{
	const int fraction = group_room(group, light);
	const int64_t *sum[3];

	memset(to, 0, sizeof(*to) * 3);
	for (int n = 0; n < group->group; n++) {
		sum_block(f, &group[n], !group[n].joins, fraction, work, sum);
		if (n + 1 == group->group || !group[n + 1].joins)
			sums_spread(group[n].block, sum, to);
	}
	return fraction;
}

/* Computes 1 - ratio = d / u; work->d: light taken away, work->u: light without the object plus e.
 * */
static void receiver_divide(const struct basis_block *b, struct tile_work *work, int exponent,
			    struct tile_values *values)
{
	for (int c = 0; c < 3; c++) {
		for (int n = 0; n < b->pixels; n++) {
			const int p = b->pixel[n];
			const int64_t own = work->u[c][p];

			/* Where no light arrives, the object takes none away. */
			if (own > 0)
				values->taken[c][p] = quotient_q24(work->d[c][p], own, exponent,
								   KERNEL_LIMIT);
		}
	}
}

/* Adds the D and U blocks of a tile. */
static void add_receivers(const struct frame_light *f, const struct block_plan *d,
			  const struct block_plan *u, struct tile_work *work,
			  struct tile_values *values)
{
	const int d_fraction = receiver_sums(f, d, f->taken, work, work->d);
	const int u_fraction = receiver_sums(f, u, f->own, work, work->u);

	for (int n = 0; n < d->group; n++)
		receiver_divide(d[n].block, work, u_fraction - d_fraction, values);
}

const int32_t tile_nothing[BLOCK_PIXELS] __attribute__((aligned(64)));

void tile_compute(const struct frame_light *f, const struct tile_plan *tile,
		  const struct block_plan *after, struct tile_work *work,
		  struct tile_values *values)
{
	const struct block_plan *d = NULL;
	bool no_object = true, nothing_taken = true; /* yet */

	work->end = tile->blocks + tile->block_count;
	work->after = after;
	for (int n = 0; n < tile->block_count; n += tile->blocks[n].group) {
		const struct block_plan *group = &tile->blocks[n];

		switch (group->block->kind) {
		case BASIS_KIND_T:
			no_object = group_add(f, group, f->object, f->gain_bits, no_object, work,
					      values->object);
			break;
		case BASIS_KIND_V:
			nothing_taken = group_add(f, group, &f->ground[group->block->ground], 0,
						  nothing_taken, work, values->taken);
			break;
		case BASIS_KIND_D:
			d = group;
			break;
		default: /* U comes after D */
			if (nothing_taken)
				memset(values->taken, 0, sizeof(values->taken));
			nothing_taken = false;
			if (d)
				add_receivers(f, d, group, work, values);
			break;
		}
	}
	if (tile->object && no_object)
		memset(values->object, 0, sizeof(values->object));
	if (tile->taken && nothing_taken)
		memset(values->taken, 0, sizeof(values->taken));
}
