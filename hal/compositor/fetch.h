/* SPDX-License-Identifier: MIT */
/*
 * Asks memory for what the blocks that come next will read. Private to hal/compositor.
 *
 * A block is too short, and what is read of it too scattered, for the processor to find out by
 * itself what comes next.
 */
#ifndef INLAY_HAL_COMPOSITOR_FETCH_H
#define INLAY_HAL_COMPOSITOR_FETCH_H

#include <stddef.h>
#include <stdint.h>

#include "hal/compositor/column_choice.h"
#include "hal/compositor/kernels/kernels.h"

#define FETCH_RANGES 9
/* More columns of 16 bits than these are a stream, which their sums ask for by themselves. */
#define FETCH_COLUMNS 128

/* Bytes that lie together. */
struct fetch_range {
	const char *from;
	size_t lines; /* cache lines */
};

/* What is still to be asked for. */
struct fetch {
	struct fetch_range range[FETCH_RANGES];
	int ranges, next;
	size_t lines, lines_step; /* of all ranges; how many at a time */
	/* Columns, a few of many. */
	const struct chosen_column *chosen;
	int column_count;
	const char *columns;
	size_t column_bytes;	 /* from a column to that of the next number */
	size_t line_bytes;	 /* from a line of a column to its next */
	int column_lines;	 /* of a column; 0: as its record has */
	int column, column_step; /* the next one; how many at a time */
};

/* While `plan` is added up: of the next block its lines, of the one after it what its columns are
 * weighed by; NULL: not known. */
void fetch_expect(struct fetch *fetch, const struct block_plan *plan, const struct block_plan *next,
		  const struct block_plan *after);

/* To the second cache: the few lines that the first one can wait for at a time are those that are
 * read now. Asked for there, a frame of 1,626 lights took a tenth to a fifth longer. */
static inline __attribute__((always_inline)) void fetch_line(const void *line)
{
	__builtin_prefetch(line, 0, 2);
}

/*
 * Asks for some of it: once for each panel of a block's columns and coefficients, and twice more.
 * Asked for all at once it would have to wait for itself. Inline by force: gcc 12 sees no effect in
 * prefetching, and drops a call.
 */
static inline __attribute__((always_inline)) void fetch_some(struct fetch *f)
{
	const int left = f->column_count - f->column;
	const int end = f->column + (left < f->column_step ? left : f->column_step);
	size_t lines = f->lines_step;

	for (int k = f->column; k < end; k++) {
		const char *from = f->columns + f->chosen[k].place * f->column_bytes;
		int line = f->column_lines;

		/* a record may begin and end anywhere in a line */
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
