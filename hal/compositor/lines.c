/* SPDX-License-Identifier: MIT */
#include "hal/compositor/lines.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis_lines.h"

/* Allocates room for the unpacked lines of one panel. */
static int unpacked_create(struct line_set *set, size_t padded)
{
	void *unpacked;

	set->number = calloc(padded, sizeof(*set->number));
	set->at = calloc(padded, sizeof(*set->at));
	if (!set->number || !set->at ||
	    posix_memalign(&unpacked, KERNEL_LINE_BYTES, 3 * padded * KERNEL_LINE_BYTES) != 0)
		return -ENOMEM;
	set->unpacked = unpacked;
	for (size_t k = 0; k < padded; k++)
		set->number[k] = (uint32_t)k;
	return 0;
}

int line_set_create(struct line_set *set, size_t most, bool columns)
{
	const size_t padded = (most + 2) / 2 * 2;
	bool fine;

	set->line = calloc(padded, sizeof(*set->line));
	set->weight = calloc(padded, sizeof(*set->weight));
	set->digit = calloc(3 * KERNEL_DIGITS * padded, sizeof(*set->digit));
	fine = set->line && set->weight && set->digit;
	return fine && (!columns || unpacked_create(set, padded) == 0) ? 0 : -ENOMEM;
}

void line_set_free(struct line_set *set)
{
	free(set->line);
	free(set->weight);
	free(set->digit);
	free(set->number);
	free(set->at);
	free(set->unpacked);
}

void line_set_split(struct line_set *set, const struct kernels *kernels)
{
	const int even = set->count + set->count % 2;

	set->line[set->count] = 0;
	memset(set->weight[set->count], 0, sizeof(*set->weight));
	set->kernel = (struct kernel_weights){
		.count = even,
		.digits = kernels->split(set->weight, even, set->digit),
		.line = set->line,
		.digit = set->digit,
	};
}

/* First 16-bit line of a block, and strides from line to line, channel and panel. */
struct places {
	const char *first;
	size_t step, channel, panel;
};

static struct places places_of16(const struct basis_block *b, const int16_t *lines, int count)
{
	const size_t panel = (size_t)count * KERNEL_LINE_BYTES;

	return (struct places){
		(const char *)lines,
		KERNEL_LINE_BYTES,
		panel * (size_t)basis_panels16(b->pixels),
		panel,
	};
}

/* Returns the target from pixel `at` on. */
static struct line_target target_from(const struct line_target *to, int at)
{
	struct line_target there = *to;

	for (int c = 0; c < 3; c++) {
		if (to->value[c])
			there.value[c] += at;
		else
			there.sum[c] += at;
	}
	return there;
}

/* Adds 16-bit lines to a block's pixels, to sums times 2^shift. */
static void add_set(const struct line_set *set, const struct basis_block *b, struct places places,
		    int shift, bool fresh, const struct kernels *kernels, struct fetch *fetch,
		    const struct line_target *target)
{
	struct kernel_weights w = set->kernel;

	w.shift = shift;
	w.fresh = fresh;
	w.step = places.step;
	w.channel = b->channels == 3 ? places.channel : 0;
	for (int at = 0; at < b->pixels; at += KERNEL_LINE16, places.first += places.panel) {
		const struct line_target to = target_from(target, at);

		if (to.value[0])
			kernels->values16((const int16_t *)places.first, &w, to.value);
		else
			kernels->sums16((const int16_t *)places.first, &w, to.sum);
		fetch_some(fetch);
	}
}

/* Finds the records of the set. */
static void find_records(struct line_set *set, const struct basis_block *b, int lines)
{
	for (int k = 0; k < set->count; k++) {
		const uint32_t at = set->records ? set->line[k] : b->record_at[set->line[k]];

		set->at[k].code = b->record + at;
		set->at[k].line = set->at[k].code + basis_record_head(lines);
	}
}

/* Unpacks the lines of one panel, channel by channel. */
static void unpack_panel(struct line_set *set, int panel, int channels)
{
	for (int k = 0; k < set->count; k++) {
		const uint8_t *code = set->at[k].code + (size_t)(panel * channels);

		for (int c = 0; c < channels; c++) {
			const size_t to = (size_t)(c * set->kernel.count + k) * KERNEL_LINE_BYTES;

			basis_line_unpack(code[c], set->at[k].line, set->unpacked + to);
			set->at[k].line += basis_line_bytes(code[c]);
		}
	}
	/* The line that makes their number even has weight 0. */
	for (int c = 0; c < channels && set->count % 2; c++)
		memset(set->unpacked +
			       (size_t)((c + 1) * set->kernel.count - 1) * KERNEL_LINE_BYTES,
		       0, KERNEL_LINE_BYTES);
}

/* Adds 8-bit columns to a block's pixels, to sums times 2^shift. Returns the number of bytes read.
 * */
static size_t add_records(struct line_set *set, const struct basis_block *b, int shift, bool fresh,
			  const struct kernels *kernels, struct fetch *fetch,
			  const struct line_target *target)
{
	struct kernel_weights w = set->kernel;
	size_t bytes = 0;

	find_records(set, b, basis_record_lines(b->pixels, b->channels));
	w.line = set->number;
	w.shift = shift;
	w.fresh = fresh;
	w.step = KERNEL_LINE_BYTES;
	w.channel = b->channels == 3 ? (size_t)w.count * KERNEL_LINE_BYTES : 0;
	for (int panel = 0; panel * KERNEL_LINE8 < b->pixels; panel++) {
		const struct line_target to = target_from(target, panel * KERNEL_LINE8);

		unpack_panel(set, panel, b->channels);
		if (to.value[0])
			kernels->values8(set->unpacked, &w, to.value);
		else
			kernels->sums8(set->unpacked, &w, to.sum);
		fetch_some(fetch);
	}
	for (int k = 0; k < set->count; k++)
		bytes += (size_t)(set->at[k].line - set->at[k].code);
	return bytes;
}

size_t lines_add(const struct kernels *kernels, const struct basis_block *b,
		 struct line_set *patterns, struct line_set *columns, int shift, bool fresh,
		 struct fetch *fetch, const struct line_target *to)
{
	const int panels = basis_panels16(b->pixels);
	size_t bytes = (size_t)(b->channels * panels * patterns->count) * KERNEL_LINE_BYTES;

	if (columns->kernel.digits && b->bits == 8) {
		bytes += add_records(columns, b, shift, fresh, kernels, fetch, to);
		fresh = false;
	} else if (columns->kernel.digits) {
		add_set(columns, b, places_of16(b, b->column16, b->columns), shift, fresh, kernels,
			fetch, to);
		bytes += (size_t)(b->channels * panels * columns->count) * KERNEL_LINE_BYTES;
		fresh = false;
	}
	if (patterns->kernel.digits) {
		add_set(patterns, b, places_of16(b, b->coefficient, b->patterns), 0, fresh, kernels,
			fetch, to);
		fresh = false;
	}
	for (int c = 0; c < 3 && fresh; c++) {
		if (to->value[c])
			memset(to->value[c], 0, (size_t)b->pixels * sizeof(*to->value[c]));
		else
			memset(to->sum[c], 0, (size_t)b->pixels * sizeof(*to->sum[c]));
	}
	return bytes;
}
