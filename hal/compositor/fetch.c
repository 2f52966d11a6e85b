/* SPDX-License-Identifier: MIT */
#include "hal/compositor/fetch.h"

#include "hal/basis/basis_layout.h"

/* Limit for a block: a small part of a second-level cache. */
#define LINES_MAX 1024
/* A block is prefetched in so many calls of fetch_some(): each block makes at least three. */
#define CALLS 3
/* How many blocks ahead the plans and blocks themselves are prefetched. */
#define STRUCTS_AHEAD 4

/* Forced inline because gcc 12 drops calls of functions that only prefetch. */
static inline __attribute__((always_inline)) void fetch_struct(const void *from, size_t bytes)
{
	for (size_t at = 0; at < bytes; at += KERNEL_LINE_BYTES)
		fetch_line((const char *)from + at);
}

/* Expects all arrays from the tint to the coefficients. Without a choice the lights and scales of
 * columns, which follow, are read, too. */
static void expect_arrays(struct fetch *fetch, const struct block_plan *plan)
{
	const struct basis_block *b = plan->block;
	const void *columns = b->bits == 8 ? (const void *)b->record_at : b->column16;
	const char *end = plan->choice ? (const char *)b->light : columns;

	fetch->from = b->tint ? (const char *)b->tint : (const char *)b->pattern_scale;
	fetch->lines = (size_t)(end - fetch->from) / KERNEL_LINE_BYTES;
	if (fetch->lines > LINES_MAX)
		fetch->lines = LINES_MAX;
	fetch->lines_step = fetch->lines / CALLS + 1;
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
	fetch->column_step = fetch->column_count / CALLS + 1;
}

void fetch_expect(struct fetch *fetch, const struct block_plan *next)
{
	*fetch = (struct fetch){.from = NULL};
	if (!next)
		return;
	fetch_struct(next + STRUCTS_AHEAD, sizeof(*next));
	fetch_struct(next->block + STRUCTS_AHEAD, sizeof(*next->block));
	expect_arrays(fetch, next);
	if (next->choice)
		expect_columns(fetch, next);
}
