/* SPDX-License-Identifier: MIT */
#include "hal/compositor/block_sums.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis_layout.h"
#include "hal/compositor/column_choice.h"
#include "hal/compositor/kernels/fixed.h"

/* Lines of each channel to prefetch before they are streamed; after these the processor prefetches
 * by itself. */
#define STREAM_AHEAD 128

int block_work_create(struct block_work *work, const struct basis *basis)
{
	const size_t columns = basis->info.lights +
			       basis->info.coarse; /* of lights, and of groups */
	bool fine;

	work->y = calloc(BASIS_PATTERNS_MAX, sizeof(*work->y));
	fine = work->y && line_set_create(&work->patterns, BASIS_PATTERNS_MAX, false) == 0 &&
	       line_set_create(&work->columns, columns, true) == 0;
	if (!fine)
		block_work_free(work);
	return fine ? 0 : -ENOMEM;
}

void block_work_free(struct block_work *work)
{
	free(work->y);
	line_set_free(&work->patterns);
	line_set_free(&work->columns);
	memset(work, 0, sizeof(*work));
}

void block_work_begin(struct block_work *work)
{
	work->counts = (struct compositor_frame){0};
}

/* ---- weights ---- */

static void weigh_patterns(struct block_work *work, const struct basis_block *b,
			   const struct block_request *request, const double one[3])
{
	struct line_set *set = &work->patterns;

	set->count = b->patterns;
	if (!b->patterns)
		return;
	request->kernels->project(b->pattern, b->patterns, b->stride, request->light->planes,
				  work->y);
	for (int c = 0; c < 3; c++) {
		const double unit = request->light->unit[c] * one[c];

		for (int j = 0; j < b->patterns; j++)
			set->weight[j][c] = round_whole((double)work->y[j][c] *
							((double)b->pattern_scale[j] * unit));
	}
	for (int j = 0; j < b->patterns; j++)
		set->line[j] = (uint32_t)j;
}

/* Prefetches the first 16-bit lines of a stream while their weights are computed. */
static inline __attribute__((always_inline)) void fetch_stream(const struct basis_block *b,
							       size_t channel, int k)
{
	const int16_t *line = b->column16 + (size_t)k * BASIS_LINE16;

	for (int c = 0; c < b->channels && k < STREAM_AHEAD; c++, line += channel)
		fetch_line(line);
}

static inline void weigh_column(int64_t to[KERNEL_WEIGHT], const struct light_sent *sent,
				double scale, const double one[3])
{
	for (int c = 0; c < 3; c++)
		to[c] = round_whole(sent->amount[c] * (scale * one[c]));
}

/* Weighs the columns that column_choice has chosen. */
static void weigh_chosen(struct line_set *set, const struct block_plan *plan,
			 const struct light_sent *sent, const double one[3])
{
	int count;
	const struct chosen_column *chosen = columns_chosen(plan, &count);
	int64_t(*const to)[KERNEL_WEIGHT] = set->weight;
	uint32_t *line = set->line;

	set->count = count;
	set->records = plan->block->bits == 8;
	for (int k = 0; k < count; k++) {
		weigh_column(to[k], &sent[chosen[k].light], (double)chosen[k].scale, one);
		line[k] = chosen[k].place;
	}
}

/* Weighs all columns whose light is not 0. Has no unpredictable branch: a dark column is written,
 * too, and overwritten by the next. */
static void weigh_lit(struct line_set *set, const struct block_plan *plan,
		      const struct light_vector *vector, const double one[3])
{
	const struct light_terms *terms = vector->terms;
	const struct light_sent *sent =
		vector->sent +
		(plan->lamps ? light_terms_lamp(terms) - terms->lights - terms->coarse : 0);
	const struct basis_block *b = plan->block;
	const bool stream = b->bits == 16 && b->columns > FETCH_COLUMNS;
	const uint16_t *light = b->light;
	const float *scale = b->column_scale;
	const size_t channel = basis_line16(basis_panels16(b->pixels), b->columns, 1, 0, 0) *
			       BASIS_LINE16;
	int64_t(*const to)[KERNEL_WEIGHT] = set->weight;
	uint32_t *line = set->line;
	int count = 0;

	set->records = false;
	for (int n = 0; n < b->columns; n++) {
		const double *x = sent[light[n]].amount;

		if (stream)
			fetch_stream(b, channel, n);
		weigh_column(to[count], &sent[light[n]], (double)scale[n], one);
		line[count] = (uint32_t)n;
		count += x[0] + x[1] + x[2] > 0;
	}
	set->count = count;
}

static void weigh_columns(struct block_work *work, const struct block_plan *plan,
			  const struct block_request *request, const double one[3], int shift)
{
	const double less = power_of_two(-shift);
	const double column_one[3] = {one[0] * less, one[1] * less, one[2] * less};
	struct line_set *set = &work->columns;

	if (plan->choice)
		weigh_chosen(set, plan, request->light->sent, column_one);
	else
		weigh_lit(set, plan, request->light, column_one);
	work->counts.columns += set->count;
}

/* Computes the weights of a block. one: the integer that stands for 1, in each channel; for columns
 * it has `shift` bits less. */
static void weigh_lines(struct block_work *work, const struct block_plan *plan,
			const struct block_request *request, const double one[3], int shift)
{
	const struct basis_block *b = plan->block;

	fetch_expect(&work->next, request->next);
	weigh_columns(work, plan, request, one, shift);
	fetch_some(&work->next);
	weigh_patterns(work, b, request, one);
	fetch_some(&work->next);
	work->counts.basis_bytes += (size_t)b->patterns * (size_t)b->stride * sizeof(int16_t);
}

static void block_add_lines(struct block_work *work, const struct block_plan *plan,
			    const struct block_request *request, const struct line_target *to)
{
	line_set_split(&work->patterns, request->kernels);
	line_set_split(&work->columns, request->kernels);
	work->counts.basis_bytes += lines_add(request->kernels, plan->block, &work->patterns,
					      &work->columns, plan->column_shift, request->fresh,
					      &work->next, to);
}

void block_sums(struct block_work *work, const struct block_plan *plan,
		const struct block_request *request, int fraction, const int64_t *sum[3])
{
	const double unit = power_of_two(fraction), one[3] = {unit, unit, unit};
	const struct line_target to = {.sum = {work->sum[0], work->sum[1], work->sum[2]}};

	weigh_lines(work, plan, request, one, plan->column_shift);
	block_add_lines(work, plan, request, &to);
	for (int c = 0; c < 3; c++)
		sum[c] = to.sum[c];
}

void block_values(struct block_work *work, const struct block_plan *plan,
		  const struct block_request *request, int fraction, int32_t *const value[3])
{
	const struct line_target to = {.value = {value[0], value[1], value[2]}};
	const int shift = plan->block->bits == 8 ? KERNEL_VALUE_SHIFT16 - KERNEL_VALUE_SHIFT8 : 0;
	double one[3];

	for (int c = 0; c < 3; c++)
		one[c] = (double)request->light->factor[c] * power_of_two(fraction - 30);
	weigh_lines(work, plan, request, one, shift);
	block_add_lines(work, plan, request, &to);
}
