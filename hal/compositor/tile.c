/* SPDX-License-Identifier: MIT */
#include "hal/compositor/tile.h"

#include <string.h>

#include "hal/compositor/column_choice.h"
#include "hal/compositor/kernels/fixed.h"

/* Fraction bits of O and 1 - ratio. */
#define VALUE_BITS 24
/* What parts of a value may come to together, so that no sum of some of them, and of their
 * roundings, leaves int32, or reaches KERNEL_LIMIT. */
#define ORDINARY 63.0

/* How the sums of a group become values. */
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

/* The next block that is summed; NULL: there is none. */
static const struct block_plan *block_next(const struct frame_light *f,
					   const struct block_plan *plan)
{
	do
		plan++;
	while (plan < f->end && !block_counts(plan));
	return plan < f->end ? plan : NULL;
}

static struct block_request request_for(const struct frame_light *f, const struct block_plan *plan,
					bool fresh)
{
	const struct block_plan *next = block_next(f, plan);

	return (struct block_request){
		.kernels = f->kernels,
		.light = block_light(f, plan->block),
		.kept = &f->kept,
		.kept_index = (int)(plan - f->first),
		.fresh = fresh,
		.next = next,
		.after = next ? block_next(f, next) : NULL,
	};
}

static void sum_block(const struct frame_light *f, const struct block_plan *plan, bool fresh,
		      int fraction, struct block_work *work, const int64_t *sum[3])
{
	const struct block_request request = request_for(f, plan, fresh);

	block_sums(work, plan, &request, fraction, sum);
}

/* Light beyond all measure has so few fraction bits that its sums must be shifted up, not down:
 * what does not fit is beyond any limit that comes later. */
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

/* Adds sums of `count` pixels to the values of as many; fresh: to nothing. */
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

/* Adds the sums of blocks that share them, plan being the last of these. */
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

/* ---- few lines in light of ordinary strength, which most groups are ---- */

/* How many lines of a group count. Blocks whose sums are kept have more of them than KERNEL_RUN. */
static int group_lines(const struct block_plan *group)
{
	int lines = 0;

	for (int n = 0; n < group->group; n++) {
		int columns = group[n].block->columns;

		if (group[n].choice)
			columns_chosen(&group[n], &columns);
		lines += group[n].block->patterns + columns;
	}
	return lines;
}

/* Values of the pixels that a block lists, to where they belong. */
static void place_values(const struct frame_light *f, const struct block_plan *plan, bool fresh,
			 int32_t *const listed[3], int32_t (*values)[BLOCK_PIXELS])
{
	const struct basis_block *b = plan->block;

	for (int c = 0; c < 3; c++) {
		if (b->tint)
			f->kernels->tint(listed[c], b->tint + c * b->pixels, b->pixels);
		if (fresh)
			memset(values[c], 0, sizeof(values[c]));
		f->kernels->place(listed[c], plan->row, values[c]);
	}
}

/* What group_add() does, where no sum is needed exactly. Values of a whole tile are made where they
 * belong. */
static bool group_add_values(const struct frame_light *f, const struct block_plan *group,
			     int fraction, bool fresh, struct tile_work *work,
			     int32_t (*values)[BLOCK_PIXELS])
{
	int32_t *const whole[3] = {values[0], values[1], values[2]};
	int32_t *const listed[3] = {work->listed, work->listed + BLOCK_PIXELS,
				    work->listed + 2 * BLOCK_PIXELS};
	const bool first = fresh; /* else what stands there may be near the limit */
	bool begun = false;	  /* one of those that list the same pixels */

	for (int n = 0; n < group->group; n++) {
		const struct block_plan *plan = &group[n];
		const bool direct = first && plan->whole && !plan->block->tint;

		if (block_counts(plan)) {
			const struct block_request request = request_for(f, plan,
									 direct ? fresh : !begun);

			block_values(&work->block, plan, &request, fraction,
				     direct ? whole : listed);
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
 * Adds a group of T or V blocks to the values, which are 0 if fresh, whatever stands there. Returns
 * whether they still are: where none of the blocks counts, nothing is done. Where light is so
 * strong that a part might reach the limit of Q24, and another part or a dark tint take it back,
 * they are added up before they are folded.
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
	bool summed = false; /* of those that share their sums */

	if (ordinary && group_lines(group) <= KERNEL_RUN)
		return group_add_values(f, group, VALUE_BITS + KERNEL_VALUE_SHIFT16 + more, fresh,
					work, values);
	if (!apart)
		memset(work->d, 0, sizeof(work->d));
	for (int n = 0; n < group->group; n++) {
		if (block_counts(&group[n])) {
			sum_block(f, &group[n], !summed, fraction, &work->block, sum);
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
		sum_block(f, &group[n], !group[n].joins, fraction, &work->block, sum);
		if (n + 1 == group->group || !group[n + 1].joins)
			sums_spread(group[n].block, sum, to);
	}
	return fraction;
}

/* d: light taken away; u: the receiver's own light without the object, e included. */
static void receiver_divide(const struct basis_block *b, struct tile_work *work, int exponent,
			    struct tile_values *values)
{
	for (int c = 0; c < 3; c++) {
		for (int n = 0; n < b->pixels; n++) {
			const int p = b->pixel[n];
			const int64_t own = work->u[c][p];

			/* Where no light can arrive, none is taken away. */
			if (own > 0)
				values->taken[c][p] = quotient_q24(work->d[c][p], own, exponent,
								   KERNEL_LIMIT);
		}
	}
}

/* The D and the U blocks of a tile. */
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

void tile_compute(const struct frame_light *f, const struct tile_plan *tile, struct tile_work *work,
		  struct tile_values *values)
{
	const struct block_plan *d = NULL;
	bool no_object = true, nothing_taken = true; /* yet */

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
