#include "hal/compositor/tile.h"

#include <string.h>

#include "hal/compositor/fixed.h"

/* Fraction bits of O and 1 - ratio. */
#define VALUE_BITS 24

/* How a sum becomes a value. */
struct folding {
	int shift;
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

/* Adds the block to the values of one channel. */
static void fold(const struct frame_light *f, const struct block_plan *plan, const int64_t *sum,
		 const struct folding *how, int c, struct tile_work *work, int32_t *values)
{
	const struct basis_block *b = plan->block;
	const uint16_t *tint = b->tint ? b->tint + c * b->pixels : NULL;
	int shift = how->shift;

	if (shift < 1) {
		sum = lifted(sum, b->pixels, 1 - shift, work->block.sum[c]);
		shift = 1;
	}
	if (plan->whole) {
		f->kernels->fold(sum, b->pixels, shift, how->factor[c], tint, values);
		return;
	}
	for (int p = 0; p < b->pixels; p++)
		work->listed[p] = values[b->pixel[p]];
	f->kernels->fold(sum, b->pixels, shift, how->factor[c], tint, work->listed);
	for (int p = 0; p < b->pixels; p++)
		values[b->pixel[p]] = work->listed[p];
}

static int fraction_of(const struct block_plan *plan, const struct light_vector *light, int more)
{
	const int room = PLAN_SUM_BITS - plan->bound - light->reach;

	return plan->fraction + more < room ? plan->fraction + more : room;
}

static void add_object(const struct frame_light *f, const struct block_plan *plan,
		       struct tile_work *work, struct tile_values *values)
{
	const int fraction = fraction_of(plan, f->object, f->gain_bits);
	const struct folding how = {fraction - VALUE_BITS - f->gain_bits, f->object->factor};
	const int64_t *sum[3];

	sums_of(f, plan, f->object, fraction, &work->block, sum);
	for (int c = 0; c < 3; c++)
		fold(f, plan, sum[c], &how, c, work, values->object[c]);
}

static void add_ground(const struct frame_light *f, const struct block_plan *plan,
		       struct tile_work *work, struct tile_values *values)
{
	const struct light_vector *light = &f->ground[plan->block->ground];
	const int fraction = fraction_of(plan, light, 0);
	const struct folding how = {fraction - VALUE_BITS, light->factor};
	const int64_t *sum[3];

	sums_of(f, plan, light, fraction, &work->block, sum);
	for (int c = 0; c < 3; c++)
		fold(f, plan, sum[c], &how, c, work, values->taken[c]);
}

/* ---- receivers with a u of their own ---- */

static void add_receiver(const struct frame_light *f, const struct block_plan *plan,
			 const struct light_vector *light, int fraction, struct block_work *work,
			 int64_t (*to)[BLOCK_PIXELS])
{
	const struct basis_block *b = plan->block;
	const int64_t *sum[3];

	sums_of(f, plan, light, fraction, work, sum);
	for (int c = 0; c < 3; c++) {
		for (int p = 0; p < b->pixels; p++)
			to[c][b->pixel[p]] += b->tint ? mul_q15(sum[c][p],
								b->tint[c * b->pixels + p])
						      : sum[c][p];
	}
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

static void add_receivers(const struct frame_light *f, const struct tile_plan *tile,
			  struct tile_work *work, struct tile_values *values)
{
	const int d_fraction = PLAN_SUM_BITS - tile->d_bound - f->taken->reach;
	const int u_fraction = PLAN_SUM_BITS - tile->u_bound - f->own->reach;

	memset(work->d, 0, sizeof(work->d));
	memset(work->u, 0, sizeof(work->u));
	for (int n = 0; n < tile->block_count; n++) {
		const struct block_plan *plan = &tile->blocks[n];

		if (plan->block->kind == BASIS_KIND_D)
			add_receiver(f, plan, f->taken, d_fraction, &work->block, work->d);
		else if (plan->block->kind == BASIS_KIND_U)
			add_receiver(f, plan, f->own, u_fraction, &work->block, work->u);
	}
	for (int n = 0; n < tile->block_count; n++) {
		if (tile->blocks[n].block->kind == BASIS_KIND_D)
			divide(tile->blocks[n].block, work, u_fraction - d_fraction, values);
	}
}

void tile_compute(const struct frame_light *light, const struct tile_plan *tile,
		  struct tile_work *work, struct tile_values *values)
{
	bool receivers = false;

	memset(values, 0, sizeof(*values));
	for (int n = 0; n < tile->block_count; n++) {
		const struct block_plan *plan = &tile->blocks[n];

		if (plan->block->kind == BASIS_KIND_T)
			add_object(light, plan, work, values);
		else if (plan->block->kind == BASIS_KIND_V)
			add_ground(light, plan, work, values);
		else
			receivers = true;
	}
	if (receivers)
		add_receivers(light, tile, work, values);
}
