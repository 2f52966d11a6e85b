/* SPDX-License-Identifier: MIT */
/*
 * Empty, shaded or a person. A cell differs from the place where, over the channels,
 *
 *     sum of (seen - place)^2 / s^2 > WEAK
 *     s^2 = sigma^2 + (MODEL place)^2 + (SHIFT |grad place|)^2
 *
 * s has the camera's noise, what the light's model is off by, and what a camera that shakes a
 * little makes of edges. Cells that differ are the place in other light where
 *
 * - one ratio explains the cell's own three channels, but for COLOUR of its light; and around it
 * - most cells that differ are such ones,
 * - their ratio, sum(seen place / s^2) / sum(place^2 / s^2), is much the same in all channels, and
 * - seen / place changes evenly from cell to cell, as the rims of shadows do: for d, its second
 *   difference across and down, sum(d^2 place^2 / s^2) is what noise makes of it.
 *
 * Else they are a person: from STRONG on, or beside one.
 */
#include <math.h>
#include <string.h>

#include "hal/people/people_parts.h"

#define MODEL 0.02f
#define SHIFT 0.15f
#define WEAK 14.0f   /* chi-square of three channels: 0.3 % of empty cells are above */
#define STRONG 30.0f /* 1e-6 */
#define AROUND 2     /* cells on each side, for the ratio */
#define DARKEST 0.2f /* ratio of a shadow's core, and of light that came on */
#define BRIGHTEST 1.35f
#define COLOUR 0.2f	 /* of its light, by which one channel of a cell may be off */
#define ALIKE 12.0f	 /* chi-square of a cell's channels about one ratio */
#define MOST 0.34f	 /* of the cells around that differ */
#define SAME_COLOUR 1.6f /* ratio of two channels' ratios */
#define EVEN 2.5f	 /* mean of d^2 over its variance */
#define UNEVEN 0.1f	 /* of its light, that the rim of a shadow may add to d */
#define BEND_NOISE 1.5f	 /* variance of d over that of a cell: 1 + 2 / 4 */

/* RAW_OTHER is added where a cell has not the place's colour in any light. */
enum { RAW_EMPTY, RAW_WEAK, RAW_STRONG, RAW_OTHER = 4 };

/* Columns of the sums count cells that differ, and those of them that may be the place. */
enum { COUNT_PLACE = 1, COUNT_DIFFERS = 32 };

static bool may_be_place(uint8_t raw)
{
	return raw != RAW_EMPTY && !(raw & RAW_OTHER);
}

/* One channel's share of a span's deviations, and its 1 / s^2. */
static void channel_deviates(const struct people *p, const struct span *span, int c,
			     float *restrict apart, float *restrict weight)
{
	const int at = span->y * p->across + span->x, count = span->count;
	const float *place = p->place[c] + at, *seen = p->seen[c] + at;
	const float *above = place - p->across, *below = place + p->across;
	const float still = p->still[c], shot = p->shot[c];

	for (int x = 0; x < count; x++) {
		const float dx = place[x + 1] - place[x - 1], dy = below[x] - above[x];
		const float expected = place[x], off = seen[x] - expected;
		const float w = 1 / (still + shot * expected + MODEL * MODEL * expected * expected +
				     SHIFT * SHIFT * 0.25f * (dx * dx + dy * dy));

		weight[x] = w;
		apart[x] += off * off * w;
	}
}

/* Whether one ratio explains the channels of a cell, which is x cells into the weights. */
static bool has_colour_of_place(const struct people *p, int at, float *const weight[3], int x)
{
	float ss = 0, sp = 0, pp = 0, ratio;

	for (int c = 0; c < 3; c++) {
		const float w = weight[c][x], seen = p->seen[c][at], place = p->place[c][at];

		ss += w * seen * seen;
		sp += w * seen * place;
		pp += w * place * place;
	}
	ratio = sp / pp;
	return ratio >= DARKEST && ratio <= BRIGHTEST &&
	       ss - ratio * sp <= ALIKE + COLOUR * COLOUR * ratio * ratio * pp;
}

/* The first cell from x on that differs, or end. */
static int next_differing(const uint8_t *raw, int x, int end)
{
	for (uint64_t eight; x + 8 <= end; x += 8) {
		memcpy(&eight, raw + x, sizeof(eight));
		if (eight)
			break;
	}
	while (x < end && raw[x] == RAW_EMPTY)
		x++;
	return x;
}

static void judge_span(struct people *p, const struct span *span)
{
	float *const weight[3] = {p->column[0][0], p->column[0][1], p->column[0][2]};
	float *apart = p->column[1][0];
	const int at = span->y * p->across + span->x;
	const uint8_t *known = p->known + at;
	uint8_t *restrict raw = p->raw + at;
	const int count = span->count;

	memset(apart, 0, (size_t)span->count * sizeof(*apart));
	for (int c = 0; c < 3; c++)
		channel_deviates(p, span, c, apart, weight[c]);
	for (int x = 0; x < count; x++)
		raw[x] = (uint8_t)((apart[x] > WEAK) + (apart[x] > STRONG)) * known[x];
	for (int x = next_differing(raw, 0, count); x < count;
	     x = next_differing(raw, x + 1, count)) {
		if (has_colour_of_place(p, at + x, weight, x))
			for (int c = 0; c < 3; c++)
				p->product[c][0][at + x] = weight[c][x];
		else
			raw[x] |= RAW_OTHER;
		p->last_differs[span->y] = span->x + x;
	}
}

static float ratio_at(const float *seen, const float *place)
{
	return *seen / (*place > 1 ? *place : 1);
}

/* How much seen / place bends between two neighbours, squared; -1: one of them is no place. */
static float bend(const struct people *p, int c, int at, int step)
{
	const float *seen = p->seen[c] + at, *place = p->place[c] + at;
	float d;

	if ((p->raw[at - step] | p->raw[at + step]) & RAW_OTHER)
		return -1;
	d = ratio_at(seen, place) -
	    0.5f * (ratio_at(seen - step, place - step) + ratio_at(seen + step, place + step));
	return d * d;
}

/* What a cell has for the sums; the first product is its 1 / s^2 till then. */
static void cell_products(struct people *p, int x, int y)
{
	const int at = y * p->across + x;
	const bool across = x > 0 && x < p->across - 1 && p->watch[at - 1] && p->watch[at + 1];
	const bool down = y > 0 && y < p->down - 1 && p->watch[at - p->across] &&
			  p->watch[at + p->across];

	for (int c = 0; c < 3; c++) {
		const float place = p->place[c][at];
		const float w = p->product[c][0][at] * place;
		const float dx = across ? bend(p, c, at, 1) : -1;
		const float dy = down ? bend(p, c, at, p->across) : -1;
		const int known = (dx >= 0) + (dy >= 0);
		const float both = (dx >= 0 ? dx : 0) + (dy >= 0 ? dy : 0);

		p->product[c][0][at] = known ? w * place * both / (BEND_NOISE * (float)known) : 0;
		p->product[c][1][at] = w * p->seen[c][at];
		p->product[c][2][at] = w * place;
	}
}

/* ---- runs of cells that may be the place in other light ---- */

/* Cells first..last of a row: both may be, and so may some between. */
struct stretch {
	int y, first, last;
};

/* Finds the next stretch of a span from *x on, which goes on behind it. */
static bool next_stretch(const struct people *p, const struct span *span, int *x,
			 struct stretch *found)
{
	const uint8_t *raw = p->raw + span->y * p->across;
	const int end = span->x + span->count;
	int at = next_differing(raw, *x, end);

	while (at < end && !may_be_place(raw[at]))
		at = next_differing(raw, at + 1, end);
	*found = (struct stretch){span->y, at, at};
	for (int u = at; u < end && u - found->last <= 2 * AROUND; u++)
		if (may_be_place(raw[u]))
			found->last = u;
	*x = found->last + 1;
	return at < end;
}

/* Calls take() for each stretch of a span. */
static void walk_span(struct people *p, const struct span *span,
		      void (*take)(struct people *p, const struct stretch *stretch))
{
	struct stretch stretch;
	int x = span->x;

	while (p->last_differs[span->y] >= x && next_stretch(p, span, &x, &stretch))
		take(p, &stretch);
}

static void make_products(struct people *p, const struct stretch *stretch)
{
	for (int x = stretch->first; x <= stretch->last; x++)
		if (may_be_place(p->raw[stretch->y * p->across + x]))
			cell_products(p, x, stretch->y);
}

static void clear_products(struct people *p, const struct stretch *stretch)
{
	const size_t count = (size_t)(stretch->last + 1 - stretch->first);
	const int at = stretch->y * p->across + stretch->first;

	for (int c = 0; c < 3; c++)
		for (int n = 0; n < 3; n++)
			memset(p->product[c][n] + at, 0, count * sizeof(float));
}

/* Adds a row's cells left..end - 1 to the sums. */
static void add_row(struct people *p, int row, int left, int end)
{
	const uint8_t *restrict raw = p->raw + row * p->across;
	uint8_t *restrict count = p->count;

	for (int c = 0; c < 3; c++)
		for (int n = 0; n < 3; n++) {
			const float *restrict product = p->product[c][n] + row * p->across;
			float *restrict sum = p->column[c][n];

			for (int x = left; x < end; x++)
				sum[x] += product[x];
		}
	for (int x = left; x < end; x++)
		count[x] = (uint8_t)(count[x] + COUNT_DIFFERS * (raw[x] != RAW_EMPTY) +
				     COUNT_PLACE * may_be_place(raw[x]));
}

/* Sums the rows around a stretch, each column by itself. */
static void sum_columns(struct people *p, const struct stretch *stretch)
{
	const int from = stretch->first - AROUND, to = stretch->last + AROUND;
	const int left = from > 0 ? from : 0, end = to < p->across - 1 ? to + 1 : p->across;

	for (int c = 0; c < 3; c++)
		for (int n = 0; n < 3; n++)
			memset(p->column[c][n] + from, 0, (size_t)(to + 1 - from) * sizeof(float));
	memset(p->count + from, 0, (size_t)(to + 1 - from));
	for (int v = stretch->y - AROUND; v <= stretch->y + AROUND; v++)
		if (v >= 0 && v < p->down && p->last_differs[v] >= left)
			add_row(p, v, left, end);
}

static float sum_around(const struct people *p, int c, int n, int x)
{
	const float *sum = p->column[c][n] + x;

	return sum[-2] + sum[-1] + sum[0] + sum[1] + sum[2];
}

/* Whether what is seen around a cell of the summed row is the place in other light. */
static bool is_place_in_other_light(const struct people *p, int x)
{
	const uint8_t *count = p->count + x;
	const int counted = count[-2] + count[-1] + count[0] + count[1] + count[2];
	const int differ = counted / COUNT_DIFFERS, cells = counted % COUNT_DIFFERS;
	float low = INFINITY, high = 0;

	if ((float)cells < MOST * (float)differ)
		return false;
	for (int c = 0; c < 3; c++) {
		const float bends = sum_around(p, c, 0, x), sp = sum_around(p, c, 1, x);
		const float pp = sum_around(p, c, 2, x), ratio = pp > 0 ? sp / pp : 0;

		if (bends > EVEN * (float)cells + UNEVEN * UNEVEN * ratio * ratio * pp)
			return false;
		low = ratio < low ? ratio : low;
		high = ratio > high ? ratio : high;
	}
	return low >= DARKEST && high <= BRIGHTEST && high <= SAME_COLOUR * low;
}

static bool is_beside(const struct people *p, int x, int y)
{
	for (int v = y - 1; v <= y + 1; v++)
		for (int u = x - 1; u <= x + 1; u++) {
			const int there = v * p->across + u;

			if (v >= 0 && u >= 0 && v < p->down && u < p->across && p->watch[there] &&
			    (p->raw[there] % RAW_OTHER == RAW_STRONG || p->order[there]))
				return true;
		}
	return false;
}

static void judge_stretch(struct people *p, const struct stretch *stretch)
{
	const int row = stretch->y * p->across;

	sum_columns(p, stretch);
	for (int x = stretch->first; x <= stretch->last; x++)
		if (may_be_place(p->raw[row + x]) && is_place_in_other_light(p, x))
			p->verdict[row + x] = VERDICT_SHADED;
}

/* Cells that differ, and are not the place in other light. */
static void judge_others(struct people *p, const struct span *span)
{
	const int end = span->x + span->count;
	const uint8_t *raw = p->raw + span->y * p->across;
	uint8_t *verdict = p->verdict + span->y * p->across;

	for (int x = next_differing(raw, span->x, end); x < end;
	     x = next_differing(raw, x + 1, end))
		if (verdict[x] != VERDICT_SHADED &&
		    (raw[x] % RAW_OTHER == RAW_STRONG || is_beside(p, x, span->y)))
			verdict[x] = VERDICT_PERSON;
}

void judge_cells(struct people *p)
{
	for (int y = 0; y < p->down; y++)
		p->last_differs[y] = -1;
	if (p->jumped)
		memcpy(p->before, p->verdict, (size_t)p->cells);
	memset(p->verdict, VERDICT_EMPTY, (size_t)p->cells);
	for (int s = 0; s < p->span_count; s++)
		judge_span(p, &p->spans[s]);
	for (int s = 0; s < p->span_count; s++)
		walk_span(p, &p->spans[s], make_products);
	for (int s = 0; s < p->span_count; s++) {
		walk_span(p, &p->spans[s], judge_stretch);
		judge_others(p, &p->spans[s]);
	}
	for (int s = 0; s < p->span_count; s++)
		walk_span(p, &p->spans[s], clear_products);
}
