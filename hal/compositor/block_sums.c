#include "hal/compositor/block_sums.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis_layout.h"
#include "hal/compositor/digits.h"
#include "hal/compositor/fixed.h"

/* What starting from kept sums costs, in lines: they are read and written. */
#define KEPT_COST 8
/* Of each array of the next block: well inside a first cache. */
#define AHEAD_BYTES 8192
#define AHEAD_STEP 640
/* Of a block's own columns, where few of them are taken. */
#define AHEAD_LINES 16

static int line_set_create(struct line_set *set, size_t most)
{
	const size_t padded = (most + 2) / 2 * 2;
	bool fine;

	set->line = calloc(padded, sizeof(*set->line));
	fine = set->line != NULL;
	for (int c = 0; c < 3; c++) {
		set->weight[c] = calloc(padded, sizeof(*set->weight[c]));
		fine = fine && set->weight[c];
		for (int d = 0; d < KERNEL_DIGITS; d++) {
			set->digit[c][d] = calloc(padded, sizeof(*set->digit[c][d]));
			fine = fine && set->digit[c][d];
		}
	}
	return fine ? 0 : -ENOMEM;
}

static void line_set_free(struct line_set *set)
{
	free(set->line);
	for (int c = 0; c < 3; c++) {
		free(set->weight[c]);
		for (int d = 0; d < KERNEL_DIGITS; d++)
			free(set->digit[c][d]);
	}
}

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

/* Fills the digits from the weights, and the count up to an even one. */
static void line_set_split(struct line_set *set)
{
	const int count = set->count, even = count + count % 2;

	set->line[count] = 0;
	for (int c = 0; c < 3; c++) {
		struct kernel_weights *k = &set->kernel[c];
		int64_t *weight = set->weight[c], most = 0;

		weight[count] = 0;
		for (int n = 0; n < count; n++) {
			const int64_t w = weight[n] < 0 ? -weight[n] : weight[n];

			most = w > most ? w : most;
		}
		*k = (struct kernel_weights){even, digits_of(most), set->line, {NULL}};
		for (int d = 0; d < k->digits; d++) {
			digits_split(weight, even, d, set->digit[c][d]);
			k->digit[d] = set->digit[c][d];
		}
	}
}

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

/* Those of the lights that are bright enough for some block, by the bitmap of this one. */
static void take_marked(struct line_set *set, const struct block_plan *plan,
			const struct block_request *request, double one)
{
	const struct light_vector *light = request->light;
	const int words = (light->lights + 63) / 64;

	for (int w = 0; w < words; w++) {
		uint64_t both = light->bright[w] & plan->has[w];

		for (; both; both &= both - 1) {
			const uint64_t below = (both & -both) - 1;
			const int n = plan->before[w] + __builtin_popcountll(plan->has[w] & below);
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

/* ---- what comes next ---- */

/* Where the block after this one will be read: it is too short for the processor to find out by
 * itself what comes next. */
static void expect_next(struct block_work *work, const struct basis_block *b)
{
	const size_t panels = b ? ((size_t)b->pixels + KERNEL_LINE16 - 1) / KERNEL_LINE16 : 0;

	work->next = (struct fetch){0};
	if (!b || !b->patterns)
		return;
	work->next.from[0] = (const char *)b->pattern;
	work->next.left[0] = (size_t)b->patterns * (size_t)b->stride * sizeof(*b->pattern);
	work->next.from[1] = (const char *)b->coefficient;
	work->next.left[1] = panels * (size_t)(b->channels * b->patterns) * KERNEL_LINE_BYTES;
	for (int k = 0; k < 2; k++)
		work->next.left[k] = work->next.left[k] < AHEAD_BYTES ? work->next.left[k]
								      : AHEAD_BYTES;
}

/*
 * Asks for some of it, between the sums of two panels: asked for all at once it would have to wait
 * for itself. Inline by force: gcc 12 sees no effect in prefetching, and drops a call.
 */
static inline __attribute__((always_inline)) void fetch_some(struct fetch *next)
{
	for (int k = 0; k < 2; k++) {
		size_t bytes = AHEAD_STEP;

		bytes = bytes < next->left[k] ? bytes : next->left[k];
		for (size_t at = 0; at < bytes; at += KERNEL_LINE_BYTES)
			__builtin_prefetch(next->from[k] + at);
		next->from[k] += bytes;
		next->left[k] -= bytes;
	}
}

/* ---- lines ---- */

static void add_patterns(struct block_work *work, const struct basis_block *b,
			 const struct kernels *kernels, int64_t *sum[3])
{
	const struct line_set *set = &work->patterns;
	const size_t panel_size = (size_t)b->patterns * KERNEL_LINE16;
	const int16_t *lines = b->coefficient;

	if (!set->count)
		return;
	for (int at = 0; at < b->pixels; at += KERNEL_LINE16) {
		for (int c = 0; c < 3; c++) {
			if (set->kernel[c].digits)
				kernels->sums16(lines + (b->channels == 3 ? c : 0) * panel_size,
						&set->kernel[c], sum[c] + at);
		}
		fetch_some(&work->next);
		lines += panel_size * (size_t)b->channels;
	}
	work->counts.basis_bytes += (size_t)((b->pixels + KERNEL_LINE16 - 1) / KERNEL_LINE16 *
					     b->channels * set->count) *
				    KERNEL_LINE_BYTES;
}

static void add_columns16(const struct line_set *set, const struct basis_block *b,
			  const struct kernels *kernels, int64_t *sum[3])
{
	const size_t panel_size = (size_t)b->columns * KERNEL_LINE16;
	const int16_t *lines = b->column16;

	for (int at = 0; at < b->pixels; at += KERNEL_LINE16) {
		for (int c = 0; c < 3; c++) {
			if (set->kernel[c].digits)
				kernels->sums16(lines + (b->channels == 3 ? c : 0) * panel_size,
						&set->kernel[c], sum[c] + at);
		}
		lines += panel_size * (size_t)b->channels;
	}
}

static void add_columns8(struct block_work *work, const struct block_plan *plan,
			 const struct kernels *kernels, int64_t *sum[3])
{
	const struct basis_block *b = plan->block;
	const size_t panel_size = (size_t)b->columns * KERNEL_LINE8;
	const int8_t *lines = b->column8;

	for (int at = 0; at < b->pixels; at += KERNEL_LINE8) {
		for (int c = 0; c < 3; c++) {
			if (!work->columns.kernel[c].digits)
				continue;
			memset(work->part, 0, sizeof(work->part));
			kernels->sums8(lines + (b->channels == 3 ? c : 0) * panel_size,
				       &work->columns.kernel[c], work->part);
			for (int p = 0; p < KERNEL_LINE8; p++)
				sum[c][at + p] += work->part[p] *
						  (INT64_C(1) << plan->column_shift);
		}
		lines += panel_size * (size_t)b->channels;
	}
}

static void add_lines(struct block_work *work, const struct block_plan *plan,
		      const struct kernels *kernels, int64_t *sum[3])
{
	const struct basis_block *b = plan->block;
	const int line_pixels = b->bits == 8 ? KERNEL_LINE8 : KERNEL_LINE16;

	if (work->columns.count && b->bits == 8)
		add_columns8(work, plan, kernels, sum);
	else if (work->columns.count)
		add_columns16(&work->columns, b, kernels, sum);
	work->counts.basis_bytes += (size_t)((b->pixels + line_pixels - 1) / line_pixels *
					     b->channels * work->columns.count) *
				    KERNEL_LINE_BYTES;
	add_patterns(work, b, kernels, sum);
}

/* ---- sums that are kept ---- */

/* What each line weighs now, those left out 0, from the sets. */
static void spread(struct block_work *work, const struct block_plan *plan)
{
	const int patterns = plan->block->patterns;

	for (int c = 0; c < 3; c++) {
		memset(work->now[c], 0, sizeof(**work->now) * (size_t)plan_lines(plan));
		for (int k = 0; k < work->patterns.count; k++)
			work->now[c][k] = work->patterns.weight[c][k];
		for (int k = 0; k < work->columns.count; k++)
			work->now[c][patterns + (int)work->columns.line[k]] =
				work->columns.weight[c][k];
	}
}

/* How many lines weigh something else than in `before`, up to `most`. */
static int changed_lines(const struct block_work *work, const int64_t *before, int lines, int most)
{
	int changed = 0;

	for (int k = 0; k < lines && changed < most; k++)
		changed += work->now[0][k] != before[k] || work->now[1][k] != before[lines + k] ||
			   work->now[2][k] != before[2 * lines + k];
	return changed;
}

/* Puts into the set what the lines from `first` on have gained. */
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
			set->weight[c][set->count] = gain[c];
		set->line[set->count++] = (uint32_t)(k - first);
	}
}

static void kept_block_sums(struct block_work *work, const struct block_plan *plan,
			    const struct block_request *request, int64_t *sum[3])
{
	const int lines = plan_lines(plan), patterns = plan->block->patterns,
		  pixels = plan_sums(plan);
	const int used = work->patterns.count + work->columns.count;
	int64_t *weights = request->kept->values + plan->state;
	bool *valid = &request->kept->valid[request->kept_index];

	for (int c = 0; c < 3; c++)
		sum[c] = weights + 3 * lines + c * pixels;
	spread(work, plan);
	if (*valid && (request->kept->always ||
		       changed_lines(work, weights, lines, used) + KEPT_COST < used)) {
		take_gains(&work->patterns, work, weights, lines, 0, patterns);
		take_gains(&work->columns, work, weights, lines, patterns, lines - patterns);
		work->counts.reused = true;
	} else {
		memset(sum[0], 0, sizeof(*sum[0]) * 3 * (size_t)pixels);
	}
	line_set_split(&work->patterns);
	line_set_split(&work->columns);
	add_lines(work, plan, request->kernels, sum);
	for (int c = 0; c < 3; c++)
		memcpy(weights + c * lines, work->now[c], sizeof(*weights) * (size_t)lines);
	*valid = true;
}

void block_sums(struct block_work *work, const struct block_plan *plan,
		const struct block_request *request, int fraction, const int64_t *sum[3])
{
	const struct basis_block *b = plan->block;
	int64_t *to[3];

	expect_next(work, request->next);
	weigh_columns(work, plan, request, fraction);
	weigh_patterns(work, b, request, fraction);
	work->counts.basis_bytes += (size_t)b->patterns * (size_t)b->stride * sizeof(int16_t);
	if (plan->kept && request->kept->values) {
		kept_block_sums(work, plan, request, to);
	} else {
		for (int c = 0; c < 3; c++) {
			to[c] = work->sum[c];
			if (!plan->joins)
				memset(to[c], 0, sizeof(*to[c]) * (size_t)plan_sums(plan));
		}
		line_set_split(&work->patterns);
		line_set_split(&work->columns);
		add_lines(work, plan, request->kernels, to);
	}
	for (int c = 0; c < 3; c++)
		sum[c] = to[c];
}
