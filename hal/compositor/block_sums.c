#include "hal/compositor/block_sums.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis_layout.h"
#include "hal/compositor/fixed.h"
#include "hal/compositor/kept_sums.h"

/* Of a block's own columns, where few of them are taken. */
#define AHEAD_LINES 16

int block_work_create(struct block_work *work, const struct basis *basis)
{
	const size_t n = basis->info.lights, most = n + BASIS_PATTERNS_MAX;
	bool fine;

	work->y = calloc(BASIS_PATTERNS_MAX, sizeof(*work->y));
	fine = work->y && line_set_create(&work->patterns, BASIS_PATTERNS_MAX) == 0 &&
	       line_set_create(&work->columns, n) == 0;
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
			set->weight[c][j] = round_double((double)work->y[j][c] *
							 ((double)b->pattern_scale[j] * one));
	}
	for (int j = 0; j < b->patterns; j++)
		set->line[j] = (uint32_t)j;
}

/* Takes column n, of light i, into the set. */
static void take_column(struct line_set *set, const struct block_plan *plan,
			const struct block_request *request, int n, int i, double one)
{
	const double *x = request->light->amount[i];
	const double weight = (double)plan->block->column_scale[n] * one;

	for (int c = 0; c < 3; c++)
		set->weight[c][set->count] = round_double(x[c] * weight);
	set->line[set->count++] = (uint32_t)n;
}

/* Whether column n, of light i, may change what can be seen. */
static bool counts(const struct block_plan *plan, const struct block_request *request, int n, int i)
{
	const struct light_vector *light = request->light;
	const double *x = light->amount[i];

	if (request->all)
		return x[0] > 0 || x[1] > 0 || x[2] > 0;
	return light->strength[i] * (plan->block->column_scale[n] * plan->reach) >= 1;
}

/* Of a word; not every processor that this runs on has an instruction for it. */
static int count_bits(uint64_t x)
{
	x -= x >> 1 & UINT64_C(0x5555555555555555);
	x = (x & UINT64_C(0x3333333333333333)) + (x >> 2 & UINT64_C(0x3333333333333333));
	x = (x + (x >> 4)) & UINT64_C(0x0f0f0f0f0f0f0f0f);
	return (int)(x * UINT64_C(0x0101010101010101) >> 56);
}

/* Those of the lights that are bright enough for a block like this one, by its bitmap. */
static void take_marked(struct line_set *set, const struct block_plan *plan,
			const struct block_request *request, double one)
{
	const struct light_vector *light = request->light;
	const uint64_t *bright = light_vector_bright(light, plan->bright);
	const int words = (light->lights + 63) / 64;

	for (int w = 0; w < words; w++) {
		uint64_t both = bright[w] & plan->has[w];

		for (; both; both &= both - 1) {
			const uint64_t below = (both & -both) - 1;
			const int n = plan->before[w] + count_bits(plan->has[w] & below);
			const int i = w * 64 + __builtin_ctzll(both);

			if (counts(plan, request, n, i))
				take_column(set, plan, request, n, i, one);
		}
	}
}

static void take_listed(struct line_set *set, const struct block_plan *plan,
			const struct block_request *request, double one)
{
	const struct basis_block *b = plan->block;

	for (int n = 0; n < b->columns; n++) {
		if (counts(plan, request, n, b->light[n]))
			take_column(set, plan, request, n, b->light[n], one);
	}
}

/* Single lines here and there, which are read after the patterns have been projected. */
static inline __attribute__((always_inline)) void fetch_columns(const struct basis_block *b,
								const struct line_set *set)
{
	const char *lines = b->bits == 8 ? (const char *)b->column8 : (const char *)b->column16;
	const int pixels = b->bits == 8 ? KERNEL_LINE8 : KERNEL_LINE16;
	const int parts = (b->pixels + pixels - 1) / pixels * b->channels;

	for (int k = 0; k < set->count && k < AHEAD_LINES; k++) {
		for (int p = 0; p < parts; p++)
			__builtin_prefetch(lines + ((size_t)p * (size_t)b->columns + set->line[k]) *
							   KERNEL_LINE_BYTES);
	}
}

static void weigh_columns(struct block_work *work, const struct block_plan *plan,
			  const struct block_request *request, int fraction)
{
	const double one = power_of_two(fraction - plan->column_shift);
	struct line_set *set = &work->columns;

	set->count = 0;
	if (plan->has && !request->all) {
		take_marked(set, plan, request, one);
		fetch_columns(plan->block, set);
	} else {
		take_listed(set, plan, request, one);
	}
	work->counts.columns += set->count;
	if (!request->all)
		work->counts.columns_left_out += plan->block->columns - set->count;
}

static void fresh_block_sums(struct block_work *work, const struct block_plan *plan,
			     const struct block_request *request, int64_t *sum[3])
{
	for (int c = 0; c < 3; c++) {
		sum[c] = work->sum[c];
		if (!plan->joins)
			memset(sum[c], 0, sizeof(*sum[c]) * (size_t)plan_sums(plan));
	}
	line_set_split(&work->patterns);
	line_set_split(&work->columns);
	work->counts.basis_bytes += lines_add(request->kernels, plan->block, &work->patterns,
					      &work->columns, plan->column_shift, !plan->joins,
					      &work->next, sum);
}

void block_sums(struct block_work *work, const struct block_plan *plan,
		const struct block_request *request, int fraction, const int64_t *sum[3])
{
	const struct basis_block *b = plan->block;
	const bool kept = plan->kept && request->kept->values;
	int64_t *to[3];

	fetch_expect(&work->next, request->next);
	if (!kept || !kept_sums_step(work, plan, request, fraction, to)) {
		weigh_columns(work, plan, request, fraction);
		weigh_patterns(work, b, request, fraction);
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
