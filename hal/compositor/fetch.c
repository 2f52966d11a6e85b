/* SPDX-License-Identifier: MIT */
#include "hal/compositor/fetch.h"

#include "hal/basis/basis_layout.h"

/* Limit for each array: a small part of a second-level cache. */
#define RANGE_LINES 1024

/* Adds an array. from may be NULL if bytes is 0. */
static void expect_range(struct fetch *fetch, const void *from, size_t bytes)
{
	const size_t all = (bytes + KERNEL_LINE_BYTES - 1) / KERNEL_LINE_BYTES;
	const size_t lines = all < RANGE_LINES ? all : RANGE_LINES;

	if (!lines)
		return;
	fetch->range[fetch->ranges++] = (struct fetch_range){from, lines};
	fetch->lines += lines;
}

static void expect_lines(struct fetch *fetch, const struct basis_block *b)
{
	const size_t panels = (size_t)basis_panels16(b->pixels);

	expect_range(fetch, b->pattern,
		     (size_t)b->patterns * (size_t)b->stride * sizeof(*b->pattern));
	expect_range(fetch, b->coefficient,
		     panels * (size_t)(b->channels * b->patterns) * KERNEL_LINE_BYTES);
	expect_range(fetch, b->tint, b->tint ? 3 * (size_t)b->pixels * sizeof(*b->tint) : 0);
	expect_range(fetch, b->pattern_scale, (size_t)b->patterns * sizeof(*b->pattern_scale));
}

/* Adds what is read of a block to weigh its columns, and the structs of the block after it. */
static void expect_weights(struct fetch *fetch, const struct block_plan *plan)
{
	const struct basis_block *b = plan->block;

	if (!plan->choice) {
		expect_range(fetch, b->column_scale, (size_t)b->columns * sizeof(*b->column_scale));
		expect_range(fetch, b->light, (size_t)b->columns * sizeof(*b->light));
		if (b->record_at)
			expect_range(fetch, b->record_at,
				     (size_t)b->columns * sizeof(*b->record_at));
	}
	expect_range(fetch, plan + 1, sizeof(*plan));
	expect_range(fetch, b + 1, sizeof(*b));
}

static void expect_columns(struct fetch *fetch, const struct block_plan *plan)
{
	const struct basis_block *b = plan->block;

	fetch->chosen = columns_chosen(plan, &fetch->column_count);
	if (b->bits == 8) {
		fetch->columns = (const char *)b->record;
		fetch->line_bytes = KERNEL_LINE_BYTES;
		fetch->column_lines = 0;
		fetch->column_bytes = 1;
	} else {
		fetch->columns = (const char *)b->column16;
		fetch->line_bytes = (size_t)b->columns * KERNEL_LINE_BYTES;
		fetch->column_lines = basis_panels16(b->pixels) * b->channels;
		fetch->column_bytes = KERNEL_LINE_BYTES;
		if (fetch->column_count > FETCH_COLUMNS)
			fetch->column_count = 0;
	}
}

void fetch_expect(struct fetch *fetch, const struct block_plan *plan, const struct block_plan *next,
		  const struct block_plan *after)
{
	const struct basis_block *b = plan->block;
	const int calls = 2 + (b->columns ? basis_panels8(b->pixels) : 0) +
			  (b->patterns ? basis_panels16(b->pixels) : 0);

	fetch->ranges = fetch->next = fetch->column = 0;
	fetch->lines = 0;
	fetch->column_count = 0;
	if (next) {
		expect_lines(fetch, next->block);
		if (next->choice)
			expect_columns(fetch, next);
	}
	if (after)
		expect_weights(fetch, after);
	fetch->lines_step = fetch->lines / (size_t)calls + 1;
	fetch->column_step = fetch->column_count / calls + 1;
}
