#include "hal/compositor/lines.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

int line_set_create(struct line_set *set, size_t most)
{
	const size_t padded = (most + 2) / 2 * 2;
	bool fine;

	set->line = calloc(padded, sizeof(*set->line));
	fine = set->line != NULL;
	for (int c = 0; c < 3; c++) {
		set->weight[c] = calloc(padded, sizeof(*set->weight[c]));
		fine = fine && set->weight[c];
	}
	set->digit = calloc(3 * KERNEL_DIGITS * padded, sizeof(*set->digit));
	return fine && set->digit ? 0 : -ENOMEM;
}

void line_set_free(struct line_set *set)
{
	free(set->line);
	for (int c = 0; c < 3; c++)
		free(set->weight[c]);
	free(set->digit);
}

void line_set_split(struct line_set *set, const struct kernels *kernels)
{
	const int even = set->count + set->count % 2;

	set->line[set->count] = 0;
	for (int c = 0; c < 3; c++)
		set->weight[c][set->count] = 0;
	set->kernel = (struct kernel_weights){
		.count = even,
		.digits = kernels->split((const int64_t *const *)set->weight, even, set->digit),
		.line = set->line,
		.digit = set->digit,
	};
}

static int panels_of(const struct basis_block *b, int pixels)
{
	return (b->pixels + pixels - 1) / pixels;
}

/* Where the lines of one kind lie in a block, and from one panel to the next. */
struct places {
	const char *first;
	int pixels; /* of a line */
	size_t step, channel, panel;
};

static struct places places_of16(const struct basis_block *b, const int16_t *lines, int count)
{
	const size_t channel = (size_t)count * KERNEL_LINE_BYTES;

	return (struct places){
		(const char *)lines,	       KERNEL_LINE16, KERNEL_LINE_BYTES, channel,
		channel * (size_t)b->channels,
	};
}

static struct places places_of8(const struct basis_block *b)
{
	const size_t channel = (size_t)panels_of(b, KERNEL_LINE8) * KERNEL_LINE_BYTES;

	return (struct places){
		(const char *)b->column8, KERNEL_LINE8, channel * (size_t)b->channels, channel,
		KERNEL_LINE_BYTES,
	};
}

/* What is added counts 2^shift. */
static void add_set(const struct line_set *set, const struct basis_block *b, struct places places,
		    int shift, bool fresh, const struct kernels *kernels, struct fetch *fetch,
		    int64_t *sum[3])
{
	struct kernel_weights w = set->kernel;

	w.shift = shift;
	w.fresh = fresh;
	w.step = places.step;
	w.channel = b->channels == 3 ? places.channel : 0;
	for (int at = 0; at < b->pixels; at += places.pixels, places.first += places.panel) {
		int64_t *const to[3] = {sum[0] + at, sum[1] + at, sum[2] + at};

		if (places.pixels == KERNEL_LINE8)
			kernels->sums8((const int8_t *)places.first, &w, to);
		else
			kernels->sums16((const int16_t *)places.first, &w, to);
		fetch_some(fetch);
	}
}

size_t lines_add(const struct kernels *kernels, const struct basis_block *b,
		 const struct line_set *patterns, const struct line_set *columns, int shift,
		 bool fresh, struct fetch *fetch, int64_t *sum[3])
{
	const int pixels = b->bits == 8 ? KERNEL_LINE8 : KERNEL_LINE16;
	const int panels16 = panels_of(b, KERNEL_LINE16), panels = panels_of(b, pixels);

	if (columns->kernel.digits) {
		add_set(columns, b,
			b->bits == 8 ? places_of8(b) : places_of16(b, b->column16, b->columns),
			shift, fresh, kernels, fetch, sum);
		fresh = false;
	}
	if (patterns->kernel.digits) {
		add_set(patterns, b, places_of16(b, b->coefficient, b->patterns), 0, fresh, kernels,
			fetch, sum);
		fresh = false;
	}
	for (int c = 0; c < 3 && fresh; c++)
		memset(sum[c], 0, (size_t)b->pixels * sizeof(*sum[c]));
	return (size_t)(b->channels * (panels16 * patterns->count + panels * columns->count)) *
	       KERNEL_LINE_BYTES;
}
