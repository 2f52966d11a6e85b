#include "hal/compositor/tile.h"

#include <string.h>

#include "hal/compositor/fixed.h"

/* Fraction bits of O and 1 - ratio. */
#define VALUE_BITS 24
/* No sum of parts below 2^SAFE_BITS reaches KERNEL_LIMIT. */
#define SAFE_BITS 6

/* How the sums of a group become values. */
struct folding {
	int fraction, shift;
	const uint32_t *factor; /* [3] */
};

static void sums_of(const struct frame_light *f, const struct block_plan *plan,
		    const struct light_vector *light, int fraction, struct block_work *work,
		    const int64_t *sum[3])
{
	const bool whole_light = plan->block->kind == BASIS_KIND_D ||
				 plan->block->kind == BASIS_KIND_U;
	const struct block_request request = {
		.kernels = f->kernels,
		.light = light,
		.kept = &f->kept,
		.next = plan + 1 < f->end ? plan[1].block : NULL,
		.kept_index = (int)(plan - f->first),
		.all = f->all || whole_light,
	};

	block_sums(work, plan, &request, fraction, sum);
}

/* Light beyond all measure has so few fraction bits that its sums must be shifted up, not down:
 * what does not fit is beyond any limit that comes later. */
static const int64_t *lifted(const int64_t *sum, int count, int up, int64_t *to)
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

/* Adds sums of `count` pixels to the values of as many. */
static void fold(const struct frame_light *f, const struct folding *how, int c, const int64_t *sum,
		 int count, const uint16_t *tint, struct tile_work *work, int32_t *values)
{
	if (how->shift >= 1) {
		f->kernels->fold(sum, count, how->shift, how->factor[c], tint, values);
		return;
	}
	sum = lifted(sum, count, 1 - how->shift, work->block.sum[c]);
	f->kernels->fold(sum, count, 1, how->factor[c], tint, values);
}

/* Adds the sums of blocks that share them, plan being the last of these. */
static void fold_block(const struct frame_light *f, const struct block_plan *plan,
		       const struct folding *how, const int64_t *const sum[3],
		       struct tile_work *work, int32_t (*values)[BLOCK_PIXELS])
{
	const struct basis_block *b = plan->block;

	for (int c = 0; c < 3; c++) {
		const uint16_t *tint = b->tint ? b->tint + c * b->pixels : NULL;

		if (plan->whole) {
			fold(f, how, c, sum[c], b->pixels, tint, work, values[c]);
			continue;
		}
		for (int p = 0; p < b->pixels; p++)
			work->listed[p] = values[c][b->pixel[p]];
		fold(f, how, c, sum[c], b->pixels, tint, work, work->listed);
		for (int p = 0; p < b->pixels; p++)
			values[c][b->pixel[p]] = work->listed[p];
	}
}

static void spread(const struct basis_block *b, const int64_t *const sum[3],
		   int64_t (*to)[BLOCK_PIXELS])
{
	for (int c = 0; c < 3; c++) {
		for (int p = 0; p < b->pixels; p++)
			to[c][b->pixel[p]] += b->tint ? mul_q15(sum[c][p],
								b->tint[c * b->pixels + p])
						      : sum[c][p];
	}
}

static int room(const struct block_plan *group, const struct light_vector *light)
{
	return PLAN_SUM_BITS - group->bound - light->reach;
}

/*
 * Adds a group of T or V blocks. Where light is so strong that a part might reach the limit of Q24,
 * and another part or a dark tint take it back, they are added up before they are folded.
 */
static void add_group(const struct frame_light *f, const struct block_plan *group,
		      const struct light_vector *light, int more, struct tile_work *work,
		      int32_t (*values)[BLOCK_PIXELS])
{
	const int wanted = group->fraction + more, most = room(group, light);
	const int fraction = wanted < most ? wanted : most;
	const struct folding how = {fraction, fraction - VALUE_BITS - more, light->factor};
	const bool apart = group->single || group->bound + light->reach + more <= SAFE_BITS;
	const int64_t *sum[3];

	if (!apart)
		memset(work->d, 0, sizeof(work->d));
	for (int n = 0; n < group->group; n++) {
		sums_of(f, &group[n], light, fraction, &work->block, sum);
		if (n + 1 < group->group && group[n + 1].joins)
			continue;
		if (apart)
			fold_block(f, &group[n], &how, sum, work, values);
		else
			spread(group[n].block, sum, work->d);
	}
	for (int c = 0; c < 3 && !apart; c++)
		fold(f, &how, c, work->d[c], BLOCK_PIXELS, NULL, work, values[c]);
}

/* ---- receivers with a u of their own ---- */

static int add_receiver(const struct frame_light *f, const struct block_plan *group,
			const struct light_vector *light, struct tile_work *work,
			int64_t (*to)[BLOCK_PIXELS])
{
	const int fraction = room(group, light);
	const int64_t *sum[3];

	memset(to, 0, sizeof(*to) * 3);
	for (int n = 0; n < group->group; n++) {
		sums_of(f, &group[n], light, fraction, &work->block, sum);
		if (n + 1 == group->group || !group[n + 1].joins)
			spread(group[n].block, sum, to);
	}
	return fraction;
}

/* d: light taken away; u: the receiver's own light without the object, e included. */
static void divide(const struct basis_block *b, struct tile_work *work, int exponent,
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
	const int d_fraction = add_receiver(f, d, f->taken, work, work->d);
	const int u_fraction = add_receiver(f, u, f->own, work, work->u);

	for (int n = 0; n < d->group; n++)
		divide(d[n].block, work, u_fraction - d_fraction, values);
}

void tile_compute(const struct frame_light *f, const struct tile_plan *tile, struct tile_work *work,
		  struct tile_values *values)
{
	const struct block_plan *d = NULL;

	memset(values, 0, sizeof(*values));
	for (int n = 0; n < tile->block_count; n += tile->blocks[n].group) {
		const struct block_plan *group = &tile->blocks[n];

		switch (group->block->kind) {
		case BASIS_KIND_T:
			add_group(f, group, f->object, f->gain_bits, work, values->object);
			break;
		case BASIS_KIND_V:
			add_group(f, group, &f->ground[group->block->ground], 0, work,
				  values->taken);
			break;
		case BASIS_KIND_D:
			d = group;
			break;
		default: /* U comes after D */
			if (d)
				add_receivers(f, d, group, work, values);
			break;
		}
	}
}
