#include "hal/compositor/block_sums.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis_layout.h"
#include "hal/compositor/column_choice.h"
#include "hal/compositor/fixed.h"
#include "hal/compositor/kept_sums.h"

/* Lines of a channel that are asked for before they are streamed: by then the processor fetches
 * ahead by itself. */
#define STREAM_AHEAD 128

int block_work_create(struct block_work *work, const struct basis *basis)
{
	const size_t n = basis->info.lights, most = n + BASIS_PATTERNS_MAX;
	const size_t columns = n + basis->info.coarse; /* of lights, and of groups */
	bool fine;

	work->y = calloc(BASIS_PATTERNS_MAX, sizeof(*work->y));
	fine = work->y && line_set_create(&work->patterns, BASIS_PATTERNS_MAX, false) == 0 &&
	       line_set_create(&work->columns, columns, true) == 0;
	for (int c = 0; c < 3; c++) {
		work->now[c] = calloc(most, sizeof(*work->now[c]));
		fine = fine && work->now[c];
	}
	if (!fine)
		block_work_free(work);
	return fine ? 0 : -ENOMEM;
}

void block_work_free(struct block_work *work)
{
	free(work->y);
	line_set_free(&work->patterns);
	line_set_free(&work->columns);
	for (int c = 0; c < 3; c++)
		free(work->now[c]);
	memset(work, 0, sizeof(*work));
}

void block_work_begin(struct block_work *work)
{
	work->counts = (struct compositor_frame){0};
}

/* ---- weights ---- */

static void weigh_patterns(struct block_work *work, const struct basis_block *b,
			   const struct block_request *request, int fraction)
{
	struct line_set *set = &work->patterns;

	set->count = b->patterns;
	if (!b->patterns)
		return;
	request->kernels->project(b->pattern, b->patterns, b->stride, request->light->planes,
				  work->y);
	for (int c = 0; c < 3; c++) {
		const double one = request->light->unit[c] * power_of_two(fraction);

		for (int j = 0; j < b->patterns; j++)
			set->weight[j][c] = round_whole((double)work->y[j][c] *
							((double)b->pattern_scale[j] * one));
	}
	for (int j = 0; j < b->patterns; j++)
		set->line[j] = (uint32_t)j;
}

/* Lines of 16 bits that will be streamed begin to come while their weights are made. */
static inline __attribute__((always_inline)) void fetch_stream(const struct basis_block *b,
							       size_t channel, int k)
{
	const int16_t *line = b->column16 + (size_t)k * BASIS_LINE16;

	for (int c = 0; c < b->channels && k < STREAM_AHEAD; c++, line += channel)
		fetch_line(line);
}

static inline void weigh(int64_t to[KERNEL_WEIGHT], const struct light_sent *sent, double scale)
{
	for (int c = 0; c < 3; c++)
		to[c] = round_whole(sent->amount[c] * scale);
}

/* Of the columns that were chosen for this light. */
static void weigh_chosen(struct line_set *set, const struct block_plan *plan,
			 const struct light_sent *sent, double one)
{
	int count;
	const struct chosen_column *chosen = columns_chosen(plan, &count);
	int64_t(*const to)[KERNEL_WEIGHT] = set->weight;
	uint32_t *line = set->line;

	set->count = count;
	set->records = plan->block->bits == 8;
	for (int k = 0; k < count; k++) {
		weigh(to[k], &sent[chosen[k].light], (double)chosen[k].scale * one);
		line[k] = chosen[k].place;
	}
}

/* Of all columns that have any light. Whatever a branch would depend on nobody could foretell: one
 * that is dark is written too, and the next one over it. */
static void weigh_lit(struct line_set *set, const struct block_plan *plan,
		      const struct light_sent *sent, double one)
{
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
		weigh(to[count], &sent[light[n]], (double)scale[n] * one);
		line[count] = (uint32_t)n;
		count += x[0] + x[1] + x[2] > 0;
	}
	set->count = count;
}

static void weigh_columns(struct block_work *work, const struct block_plan *plan,
			  const struct block_request *request, int fraction)
{
	const double one = power_of_two(fraction - plan->column_shift);
	struct line_set *set = &work->columns;

	if (plan->choice)
		weigh_chosen(set, plan, request->light->sent, one);
	else
		weigh_lit(set, plan, request->light->sent, one);
	work->counts.columns += set->count;
}

static void fresh_block_sums(struct block_work *work, const struct block_plan *plan,
			     const struct block_request *request, int64_t *sum[3])
{
	for (int c = 0; c < 3; c++)
		sum[c] = work->sum[c];
	line_set_split(&work->patterns, request->kernels);
	line_set_split(&work->columns, request->kernels);
	work->counts.basis_bytes += lines_add(request->kernels, plan->block, &work->patterns,
					      &work->columns, plan->column_shift, request->fresh,
					      &work->next, sum);
}

void block_sums(struct block_work *work, const struct block_plan *plan,
		const struct block_request *request, int fraction, const int64_t *sum[3])
{
	const struct basis_block *b = plan->block;
	const bool kept = plan->kept && request->kept->values;
	int64_t *to[3];

	if (!kept || !kept_sums_step(work, plan, request, fraction, to)) {
		fetch_expect(&work->next, plan, request->next, request->after);
		weigh_columns(work, plan, request, fraction);
		fetch_some(&work->next);
		weigh_patterns(work, b, request, fraction);
		fetch_some(&work->next);
		work->counts.basis_bytes += (size_t)b->patterns * (size_t)b->stride *
					    sizeof(int16_t);
		if (kept)
			kept_sums_take(work, plan, request, fraction, to);
		else
			fresh_block_sums(work, plan, request, to);
	}
	for (int c = 0; c < 3; c++)
		sum[c] = to[c];
}
