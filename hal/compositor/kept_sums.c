/* SPDX-License-Identifier: MIT */
#include "hal/compositor/kept_sums.h"

#include <string.h>

#include "hal/compositor/kernels/fixed.h"

/* Cost of reading and writing kept sums, in lines read in the same time. */
#define KEPT_COST 8

/* Writes the new weight of each line to work->now; lines not in the sets have weight 0. */
static void weights_spread(struct block_work *work, const struct block_plan *plan)
{
	const int patterns = plan->block->patterns;

	for (int c = 0; c < 3; c++) {
		memset(work->now[c], 0, sizeof(**work->now) * (size_t)plan_lines(plan));
		for (int k = 0; k < work->patterns.count; k++)
			work->now[c][k] = work->patterns.weight[k][c];
		for (int k = 0; k < work->columns.count; k++)
			work->now[c][patterns + (int)work->columns.line[k]] =
				work->columns.weight[k][c];
	}
}

/* Counts the lines whose weight differs from `before`, up to `most`. */
static int changed_lines(const struct block_work *work, const int64_t *before, int lines, int most)
{
	int changed = 0;

	for (int k = 0; k < lines && changed < most; k++)
		changed += work->now[0][k] != before[k] || work->now[1][k] != before[lines + k] ||
			   work->now[2][k] != before[2 * lines + k];
	return changed;
}

/* Fills the set with the weight changes of `count` lines from `first`, if not 0. */
static void take_gains(struct line_set *set, const struct block_work *work, const int64_t *before,
		       int lines, int first, int count)
{
	set->count = 0;
	for (int k = first; k < first + count; k++) {
		int64_t gain[3], any = 0;

		for (int c = 0; c < 3; c++) {
			gain[c] = work->now[c][k] - before[c * lines + k];
			any |= gain[c];
		}
		if (!any)
			continue;
		for (int c = 0; c < 3; c++)
			set->weight[set->count][c] = gain[c];
		set->line[set->count++] = (uint32_t)(k - first);
	}
}

/* Returns the kept weights of a block; sets sum[] to its kept sums, which follow them. */
static int64_t *kept_weights(const struct block_plan *plan, const struct block_request *request,
			     int64_t *sum[3])
{
	int64_t *weights = request->kept->values + plan->state;

	for (int c = 0; c < 3; c++)
		sum[c] = weights + 3 * plan_lines(plan) + c * plan_sums(plan);
	return weights;
}

static void add_sets(struct block_work *work, const struct block_plan *plan,
		     const struct block_request *request, int64_t *const sum[3])
{
	const struct line_target to = {.sum = {sum[0], sum[1], sum[2]}};

	line_set_split(&work->patterns, request->kernels);
	line_set_split(&work->columns, request->kernels);
	work->counts.basis_bytes += lines_add(request->kernels, plan->block, &work->patterns,
					      &work->columns, plan->column_shift, false,
					      &work->next, &to);
}

void kept_sums_take(struct block_work *work, const struct block_plan *plan,
		    const struct block_request *request, int fraction, int64_t *sum[3])
{
	const int lines = plan_lines(plan), patterns = plan->block->patterns;
	const int used = work->patterns.count + work->columns.count;
	struct kept_block *kept = &request->kept->blocks[request->kept_index];
	int64_t *weights = kept_weights(plan, request, sum);

	weights_spread(work, plan);
	if (kept->valid && (request->kept->always ||
			    changed_lines(work, weights, lines, used) + KEPT_COST < used)) {
		take_gains(&work->patterns, work, weights, lines, 0, patterns);
		take_gains(&work->columns, work, weights, lines, patterns, lines - patterns);
		work->counts.reused = true;
	} else {
		memset(sum[0], 0, sizeof(*sum[0]) * 3 * (size_t)plan_sums(plan));
	}
	add_sets(work, plan, request, sum);
	for (int c = 0; c < 3; c++)
		memcpy(weights + c * lines, work->now[c], sizeof(*weights) * (size_t)lines);
	*kept = (struct kept_block){true, fraction};
}

bool kept_sums_step(struct block_work *work, const struct block_plan *plan,
		    const struct block_request *request, int fraction, int64_t *sum[3])
{
	const struct basis_block *b = plan->block;
	const struct light_vector *light = request->light;
	const struct kept_block *kept = &request->kept->blocks[request->kept_index];
	const double one = power_of_two(fraction - plan->column_shift);
	struct line_set *set = &work->columns;
	int64_t *weights;

	if (!kept->valid || kept->fraction != fraction || b->patterns ||
	    b->columns != light->lights ||
	    !(request->kept->always || light->changed_count + KEPT_COST < light->lit))
		return false;
	weights = kept_weights(plan, request, sum);
	work->patterns.count = set->count = 0;
	set->records = false;
	for (int k = 0; k < light->changed_count; k++) {
		const int i = light->changed[k];
		const double weight = (double)b->column_scale[i] * one;

		for (int c = 0; c < 3; c++) {
			int64_t *before = &weights[c * b->columns + i];
			const int64_t now = round_whole(light->sent[i].amount[c] * weight);

			set->weight[set->count][c] = now - *before;
			*before = now;
		}
		set->line[set->count++] = (uint32_t)i;
	}
	add_sets(work, plan, request, sum);
	work->counts.columns += light->lit;
	work->counts.reused = true;
	return true;
}
