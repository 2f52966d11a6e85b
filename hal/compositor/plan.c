/* SPDX-License-Identifier: MIT */
#include "hal/compositor/plan.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis_layout.h"
#include "hal/compositor/kernels/fixed.h"

/* Keeps the roundings of all weights of a block together below 2^-17. */
#define FRACTION_BITS 31
/* The largest value of an 8-bit column is 127 instead of 32767: 8 bits less. */
#define BYTE_SHIFT 8
/* Bound for light of lights and groups, as a multiple of sum X:
 *     sum |X - q S| + sum S <= sum X + sum q S + sum S <= 3 sum X
 */
#define GROUPED 3

static float value_of_one(const struct basis_block *b)
{
	float most = b->bits == 8 ? 127 : 32767;
	int tint = BASIS_TINT_ONE;

	for (int i = 0; b->tint && i < 3 * b->pixels; i++)
		tint = b->tint[i] > tint ? b->tint[i] : tint;
	return most * ((float)tint / BASIS_TINT_ONE);
}

/* Compares instead of calling fmax(), on which gcc 12 for Arm fails here. */
static float farthest_scale(const struct basis_block *b)
{
	float farthest = 0;

	for (int n = 0; n < b->columns; n++)
		farthest = b->column_scale[n] > farthest ? b->column_scale[n] : farthest;
	return farthest;
}

/* Returns the largest possible sum of all lines per unit of light. The coarse lights sum to no more
 * than the light that they gather. */
static double block_bound(const struct block_plan *plan)
{
	const struct basis_block *b = plan->block;
	const double most = b->bits == 8 ? 127 : 32767;
	double patterns = 0;

	for (int j = 0; j < b->patterns; j++) {
		const int16_t *row = b->pattern + (size_t)j * (size_t)b->stride;
		int highest = 0;

		for (int k = 0; k < b->stride; k++)
			highest = abs(row[k]) > highest ? abs(row[k]) : highest;
		patterns += (double)b->pattern_scale[j] * 32767 * highest;
	}
	return patterns + (double)farthest_scale(b) * most * (plan->grouped ? GROUPED : 1);
}

static int exponent_of_bound(double bound)
{
	return bound > 0 ? exponent_above(bound) : -200;
}

bool block_has_groups(const struct basis *basis, const struct basis_block *b)
{
	const uint32_t last = b->columns ? b->light[b->columns - 1] : 0;

	return last >= basis->info.lights && !block_has_lamps(basis, b);
}

bool block_has_lamps(const struct basis *basis, const struct basis_block *b)
{
	return b->columns && b->light[0] >= basis->info.lights + basis->info.coarse;
}

static struct block_plan plan_block(const struct basis *basis, const struct basis_block *b)
{
	struct block_plan plan = {
		.block = b,
		.whole = b->pixels == BASIS_TILE * BASIS_TILE,
		.column_shift = b->bits == 8 ? BYTE_SHIFT : 0,
		.grouped = block_has_groups(basis, b),
		.lamps = block_has_lamps(basis, b),
		.reach = value_of_one(b) / b->cut_share,
	};

	for (int p = 0; p < b->pixels; p++)
		plan.row[b->pixel[p] / BASIS_TILE] |= (uint16_t)(1 << b->pixel[p] % BASIS_TILE);
	return plan;
}

static bool is_covered(const struct basis *basis, const uint16_t *coverage,
		       const struct basis_tile *tile)
{
	for (int y = 0; y < tile->height; y++) {
		const uint16_t *a = coverage + (size_t)(tile->y + y) * basis->info.width + tile->x;

		for (int x = 0; x < tile->width; x++) {
			if (a[x])
				return true;
		}
	}
	return false;
}

static bool same_group(const struct basis_block *a, const struct basis_block *b)
{
	return a->kind == b->kind && a->ground == b->ground;
}

static bool same_pixels(const struct basis_block *a, const struct basis_block *b)
{
	return a->pixels == b->pixels &&
	       memcmp(a->pixel, b->pixel, sizeof(*a->pixel) * (size_t)a->pixels) == 0;
}

/* Consecutive blocks of the same pixels and channels (columns of 8 and of 16 bits, say) share the
 * columns of their groups of lights. */
static void share_groups(struct block_plan *plan, int count)
{
	for (int n = 1; n < count; n++) {
		const struct basis_block *b = plan[n].block, *before = plan[n - 1].block;

		plan[n].follows = !plan[n].lamps && b->channels == before->channels &&
				  same_pixels(b, before);
		plan[n].grouped |= plan[n].follows && plan[n - 1].grouped;
	}
	for (int n = count - 1; n > 0; n--)
		plan[n - 1].grouped |= plan[n].follows && plan[n].grouped;
}

static void plan_group(struct block_plan *plan, int count)
{
	double bound = 0;
	int lines = 0, shares = 1;

	share_groups(plan, count);
	for (int n = 0; n < count; n++) {
		const struct basis_block *b = plan[n].block;

		bound += block_bound(&plan[n]) * (b->tint ? 2 : 1);
		lines += b->patterns + b->columns;
		plan[n].joins = n > 0 && !b->tint && !plan[n - 1].block->tint &&
				same_pixels(b, plan[n - 1].block);
		shares += plan[n].joins;
	}
	for (int n = 0; n < count; n++) {
		plan[n].group = n ? 0 : count;
		plan[n].single = shares == count && !plan[0].block->tint;
		plan[n].fraction = FRACTION_BITS + exponent_above(lines);
		plan[n].most = bound;
		plan[n].bound = exponent_of_bound(bound);
	}
}

/* Finds the groups of a tile. Blocks are sorted by kind, but grounds may alternate. */
static void plan_tile(struct tile_plan *tile, struct block_plan *plan, int count)
{
	tile->blocks = plan;
	tile->block_count = count;
	for (int n = 0, next; n < count; n = next) {
		for (next = n + 1; next < count && same_group(plan[n].block, plan[next].block);)
			next++;
		plan_group(plan + n, next - n);
		*(plan[n].block->kind == BASIS_KIND_T ? &tile->object : &tile->taken) = true;
	}
}

static bool is_bounded(const struct tile_plan *tile)
{
	bool bounded = tile->bare && tile->block_count;

	for (int n = 0; n < tile->block_count; n++)
		bounded = bounded && tile->blocks[n].block->kind == BASIS_KIND_V &&
			  !tile->blocks[n].block->tint;
	return bounded;
}

/* Finds block_plan.farthest of a block, [patterns], which is zeroed. */
static void find_farthest(const struct basis_block *b, float (*farthest)[3])
{
	const int panels = basis_panels16(b->pixels);

	for (int k = 0; k < 3 * panels * b->patterns; k++) {
		const int c = k / (panels * b->patterns), j = k % b->patterns;
		const int line = b->channels == 3 ? k : k % (panels * b->patterns);
		const int16_t *value = b->coefficient + (size_t)line * BASIS_LINE16;
		int highest = 0;
		float reach;

		for (int p = 0; p < BASIS_LINE16; p++)
			highest = abs(value[p]) > highest ? abs(value[p]) : highest;
		reach = (float)highest * b->pattern_scale[j];
		farthest[j][c] = reach > farthest[j][c] ? reach : farthest[j][c];
	}
}

int layer_plan_create(struct layer_plan *plan, const struct basis *basis,
		      const struct basis_pose *pose, const struct basis_layer *layer)
{
	const int tiles = basis->tiles_across * basis->tiles_down;
	size_t patterns = 0;

	*plan = (struct layer_plan){0};
	plan->tiles = calloc((size_t)tiles + 1, sizeof(*plan->tiles));
	plan->blocks = calloc((size_t)layer->block_count + 1, sizeof(*plan->blocks));
	for (int n = 0; n < layer->block_count; n++)
		patterns += (size_t)layer->blocks[n].patterns;
	plan->farthest = calloc(patterns + 1, sizeof(*plan->farthest));
	if (!plan->tiles || !plan->blocks || !plan->farthest) {
		layer_plan_free(plan);
		return -ENOMEM;
	}
	for (int n = layer->block_count - 1; n >= 0; n--) {
		patterns -= (size_t)layer->blocks[n].patterns;
		plan->blocks[n] = plan_block(basis, &layer->blocks[n]);
		plan->blocks[n].farthest = plan->farthest + patterns;
	}
	for (int t = 0; t < tiles; t++) {
		const struct basis_tile *tile = &layer->tiles[t];
		const bool covered = is_covered(basis, pose->coverage, tile);
		struct tile_plan *p = &plan->tiles[t];

		if (tile->block_count)
			plan_tile(p, plan->blocks + (tile->blocks - layer->blocks),
				  tile->block_count);
		if (pose->glass_count)
			p->object = p->taken = true;
		p->plain = !covered && !tile->block_count;
		p->bare = !covered && !p->object;
		p->bounded = is_bounded(p);
		for (int n = 0; n < p->block_count && p->bounded; n++)
			find_farthest(p->blocks[n].block, p->blocks[n].farthest);
	}
	return 0;
}

void layer_plan_free(struct layer_plan *plan)
{
	free(plan->tiles);
	free(plan->blocks);
	free(plan->farthest);
	*plan = (struct layer_plan){0};
}
