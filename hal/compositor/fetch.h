/* SPDX-License-Identifier: MIT */
/*
 * Prefetches what the next blocks will read. Private to hal/compositor.
 *
 * A block is too short, and its reads are too scattered, for the processor's own prefetcher.
 */
#ifndef INLAY_HAL_COMPOSITOR_FETCH_H
#define INLAY_HAL_COMPOSITOR_FETCH_H

#include <stddef.h>
#include <stdint.h>

#include "hal/compositor/column_choice.h"
#include "hal/compositor/kernels/kernels.h"

#define FETCH_RANGES 9
/* More 16-bit columns than this are read as a stream, which their sums prefetch themselves. */
#define FETCH_COLUMNS 128

/* Contiguous bytes. */
struct fetch_range {
	const char *from;
	size_t lines; /* cache lines */
};

/* What remains to be prefetched. */
struct fetch {
	struct fetch_range range[FETCH_RANGES];
	int ranges, next;
	size_t lines, lines_step; /* cache lines of all ranges; how many in each call */
	/* Chosen columns. */
	const struct chosen_column *chosen;
	int column_count;
	const char *columns;
	size_t column_bytes;	 /* stride from a place to the next */
	size_t line_bytes;	 /* stride from a line of a column to its next */
	int column_lines;	 /* cache lines of a column; 0: from the length of its record */
	int column, column_step; /* the next one; how many in each call */
};

/* Plans what to prefetch while `plan` is summed: the lines of the block `next`, and the scales and
 * light numbers of the block `after`. NULL: unknown. */
void fetch_expect(struct fetch *fetch, const struct block_plan *plan, const struct block_plan *next,
		  const struct block_plan *after);

/* Prefetches to the second-level cache: the few outstanding misses of the first level are needed
 * for the lines that are read now. Prefetching to the first level made a frame of 1,626 lights 10
 * to 20 % slower. */
static inline __attribute__((always_inline)) void fetch_line(const void *line)
{
	__builtin_prefetch(line, 0, 2);
}

/*
 * Prefetches one step. Called once for each panel of a block's columns and coefficients, and twice
 * more: all at once would exceed what the memory system can have outstanding. Forced inline because
 * gcc 12 drops calls of functions that only prefetch.
 */
static inline __attribute__((always_inline)) void fetch_some(struct fetch *f)
{
	const int left = f->column_count - f->column;
	const int end = f->column + (left < f->column_step ? left : f->column_step);
	size_t lines = f->lines_step;

	for (int k = f->column; k < end; k++) {
		const char *from = f->columns + f->chosen[k].place * f->column_bytes;
		int line = f->column_lines;

		/* a record may begin and end anywhere in a cache line */
		if (!line)
			line = 1 + (int)(((uintptr_t)from % KERNEL_LINE_BYTES + f->chosen[k].bytes -
					  1) /
					 KERNEL_LINE_BYTES);
		for (; line > 0; line--, from += f->line_bytes)
			fetch_line(from);
	}
	f->column = end;
	while (lines && f->next < f->ranges) {
		struct fetch_range *range = &f->range[f->next];
		const size_t now = range->lines < lines ? range->lines : lines;
		const char *const stop = range->from + now * KERNEL_LINE_BYTES;

		for (const char *from = range->from; from < stop; from += KERNEL_LINE_BYTES)
			fetch_line(from);
		range->from = stop;
		range->lines -= now;
		lines -= now;
		f->next += range->lines == 0;
	}
}

#endif
