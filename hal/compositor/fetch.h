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

/* More 16-bit columns than this are read as a stream, which their sums prefetch themselves. */
#define FETCH_COLUMNS 128

/* What remains to be prefetched. */
struct fetch {
	const char *from; /* contiguous: what is read of a block besides its chosen columns */
	size_t lines, lines_step; /* cache lines; how many in each call */
	/* Chosen columns. */
	const struct chosen_column *chosen;
	int column_count;
	const char *columns;
	size_t column_bytes;	 /* stride from a place to the next */
	size_t line_bytes;	 /* stride from a line of a column to its next */
	int column_lines;	 /* cache lines of a column; 0: from the length of its record */
	int column, column_step; /* the next one; how many in each call */
};

/* Plans what to prefetch of the block `next` while the block before it is summed. NULL: nothing. */
void fetch_expect(struct fetch *fetch, const struct block_plan *next);

/* Prefetches to the second-level cache: the few outstanding misses of the first level are needed
 * for the lines that are read now. Prefetching to the first level made a frame of 1,626 lights 10
 * to 20 % slower. */
static inline __attribute__((always_inline)) void fetch_line(const void *line)
{
	__builtin_prefetch(line, 0, 2);
}

/*
 * Prefetches one step. Called twice for each block, and once more for each panel of its columns and
 * coefficients: all at once would exceed what the memory system can have outstanding. Forced inline
 * because gcc 12 drops calls of functions that only prefetch.
 */
static inline __attribute__((always_inline)) void fetch_some(struct fetch *f)
{
	const int left = f->column_count - f->column;
	const int end = f->column + (left < f->column_step ? left : f->column_step);
	const size_t lines = f->lines < f->lines_step ? f->lines : f->lines_step;

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
	for (size_t n = 0; n < lines; n++, f->from += KERNEL_LINE_BYTES)
		fetch_line(f->from);
	f->lines -= lines;
}

#endif
