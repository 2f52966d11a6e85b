#include "hal/compositor/lines.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/compositor/digits.h"

/* Of each array of the next block: well inside a first cache; and how much at a time. */
#define AHEAD_BYTES 8192
#define AHEAD_STEP 640

int line_set_create(struct line_set *set, size_t most)
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

void line_set_free(struct line_set *set)
{
	free(set->line);
	for (int c = 0; c < 3; c++) {
		free(set->weight[c]);
		for (int d = 0; d < KERNEL_DIGITS; d++)
			free(set->digit[c][d]);
	}
}

/* Fills the digits from the weights, and the count up to an even one. */
void line_set_split(struct line_set *set)
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

/* Where the block after this one will be read: it is too short for the processor to find out by
 * itself what comes next. */
void fetch_expect(struct fetch *fetch, const struct basis_block *b)
{
	const size_t panels = b ? ((size_t)b->pixels + KERNEL_LINE16 - 1) / KERNEL_LINE16 : 0;

	*fetch = (struct fetch){0};
	if (!b)
		return;
	fetch->from[0] = (const char *)b->pattern;
	fetch->left[0] = (size_t)b->patterns * (size_t)b->stride * sizeof(*b->pattern);
	fetch->from[1] = (const char *)b->coefficient;
	fetch->left[1] = panels * (size_t)(b->channels * b->patterns) * KERNEL_LINE_BYTES;
	fetch->from[2] = (const char *)b->column_scale;
	fetch->left[2] = (size_t)b->columns * sizeof(*b->column_scale);
	fetch->from[3] = (const char *)b->pattern_scale;
	fetch->left[3] = (size_t)b->patterns * sizeof(*b->pattern_scale);
	fetch->from[4] = (const char *)b->pixel;
	fetch->left[4] = (size_t)b->pixels * sizeof(*b->pixel);
	for (int k = 0; k < FETCHES; k++)
		fetch->left[k] = fetch->left[k] < AHEAD_BYTES ? fetch->left[k] : AHEAD_BYTES;
}

/*
 * Asks for some of it, between the sums of two panels: asked for all at once it would have to wait
 * for itself. Inline by force: gcc 12 sees no effect in prefetching, and drops a call.
 */
static inline __attribute__((always_inline)) void fetch_some(struct fetch *next)
{
	for (int k = 0; k < FETCHES; k++) {
		const size_t bytes = AHEAD_STEP < next->left[k] ? AHEAD_STEP : next->left[k];

		if (!bytes)
			continue; /* what is not there may have no address */
		for (size_t at = 0; at < bytes; at += KERNEL_LINE_BYTES)
			__builtin_prefetch(next->from[k] + at);
		next->from[k] += bytes;
		next->left[k] -= bytes;
	}
}

/* Lines of 16 bits, of which a panel has `count` for each channel. */
static void add_lines16(const struct line_set *set, const struct basis_block *b,
			const int16_t *lines, int count, const struct kernels *kernels,
			struct fetch *fetch, int64_t *sum[3])
{
	const size_t panel_size = (size_t)count * KERNEL_LINE16;

	for (int at = 0; at < b->pixels; at += KERNEL_LINE16) {
		for (int c = 0; c < 3; c++) {
			if (set->kernel[c].digits)
				kernels->sums16(lines + (b->channels == 3 ? c : 0) * panel_size,
						&set->kernel[c], sum[c] + at);
		}
		fetch_some(fetch);
		lines += panel_size * (size_t)b->channels;
	}
}

/* What is there, if anything, has `shift` bits more. */
static void add_columns8(const struct line_set *set, const struct basis_block *b,
			 const struct kernels *kernels, int shift, bool fresh, struct fetch *fetch,
			 int64_t *sum[3])
{
	const size_t panel_size = (size_t)b->columns * KERNEL_LINE8;
	const int8_t *lines = b->column8;
	int64_t part[KERNEL_LINE8] __attribute__((aligned(64)));

	for (int at = 0; at < b->pixels; at += KERNEL_LINE8) {
		for (int c = 0; c < 3; c++) {
			if (!set->kernel[c].digits)
				continue;
			if (!fresh)
				memset(part, 0, sizeof(part));
			kernels->sums8(lines + (b->channels == 3 ? c : 0) * panel_size,
				       &set->kernel[c], fresh ? sum[c] + at : part);
			for (int p = 0; fresh && p < KERNEL_LINE8; p++)
				sum[c][at + p] *= INT64_C(1) << shift;
			for (int p = 0; !fresh && p < KERNEL_LINE8; p++)
				sum[c][at + p] += part[p] * (INT64_C(1) << shift);
		}
		fetch_some(fetch);
		lines += panel_size * (size_t)b->channels;
	}
}

size_t lines_add(const struct kernels *kernels, const struct basis_block *b,
		 const struct line_set *patterns, const struct line_set *columns, int shift,
		 bool fresh, struct fetch *fetch, int64_t *sum[3])
{
	const int pixels = b->bits == 8 ? KERNEL_LINE8 : KERNEL_LINE16;
	const int panels16 = (b->pixels + KERNEL_LINE16 - 1) / KERNEL_LINE16;
	const int panels = (b->pixels + pixels - 1) / pixels;

	if (columns->count && b->bits == 8)
		add_columns8(columns, b, kernels, shift, fresh, fetch, sum);
	else if (columns->count)
		add_lines16(columns, b, b->column16, b->columns, kernels, fetch, sum);
	if (patterns->count)
		add_lines16(patterns, b, b->coefficient, b->patterns, kernels, fetch, sum);
	return (size_t)(b->channels * (panels16 * patterns->count + panels * columns->count)) *
	       KERNEL_LINE_BYTES;
}
