/* SPDX-License-Identifier: MIT */
/*
 * Empty, shaded or a person. A cell differs from the place where, over the channels,
 *
 *     sum of (seen - place)^2 / s^2 > WEAK,   s^2 = sigma^2 + (MODEL place)^2 + (SHIFT |grad place|)^2
 *
 * s has the camera's noise, what the light's model is off by, and what a camera that shakes a little
 * makes of edges. Cells that differ are the place in other light where one ratio a channel explains
 * all of them around, with much the same ratio in all channels. By weighted least squares,
 *
 *     ratio = sum(seen place / s^2) / sum(place^2 / s^2)
 *     left  = sum(seen^2 / s^2) - ratio sum(seen place / s^2)
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
#define SAME_COLOUR 1.35f /* ratio of two channels' ratios */
#define EXPLAINED 6.0f	  /* mean square of what a ratio leaves, per channel and cell */

enum { RAW_EMPTY, RAW_WEAK, RAW_STRONG };

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

/* Sets what a row has for the sums, from its first to its last cell that differs. */
static void span_products(struct people *p, const struct span *span, float *const weight[3])
{
	const int from = p->first_differs[span->y], to = p->last_differs[span->y];
	const int left = from > span->x ? from - span->x : 0;
	const int end = span->x + span->count <= to ? span->count : to + 1 - span->x;
	const int row = span->y * p->across + span->x;
	const uint8_t *raw = p->raw + row;

	for (int c = 0; c < 3; c++) {
		const float *seen = p->seen[c] + row, *place = p->place[c] + row;
		const float *own = weight[c];
		float *restrict ss = p->product[c][0] + row, *restrict sp = p->product[c][1] + row;
		float *restrict pp = p->product[c][2] + row;

		for (int x = left; x < end; x++) {
			const float w = own[x] * (float)(raw[x] != RAW_EMPTY);

			ss[x] = w * seen[x] * seen[x];
			sp[x] = w * seen[x] * place[x];
			pp[x] = w * place[x] * place[x];
		}
	}
}

static void judge_span(struct people *p, const struct span *span)
{
	float *const weight[3] = {p->column[0][0], p->column[0][1], p->column[0][2]};
	float *apart = p->column[1][0];
	const int at = span->y * p->across + span->x;
	const uint8_t *known = p->known + at;
	uint8_t *restrict raw = p->raw + at;
	const int count = span->count;
	int first = count, last = -1;

	memset(apart, 0, (size_t)span->count * sizeof(*apart));
	for (int c = 0; c < 3; c++)
		channel_deviates(p, span, c, apart, weight[c]);
	for (int x = 0; x < count; x++)
		raw[x] = (uint8_t)((apart[x] > WEAK) + (apart[x] > STRONG)) * known[x];
	for (int x = 0; x < count; x++) {
		if (!raw[x])
			continue;
		first = x < first ? x : first;
		last = x;
	}
	if (last < 0)
		return;
	if (p->last_differs[span->y] < 0)
		p->first_differs[span->y] = span->x + first;
	p->last_differs[span->y] = span->x + last;
	span_products(p, span, weight);
}

/* Adds a row's spans to the sums, as far as they differ. */
static void add_row(struct people *p, int row)
{
	for (int s = p->row_span[row]; s < p->row_span[row + 1]; s++) {
		const struct span *span = &p->spans[s];
		const int first = p->first_differs[row], last = p->last_differs[row];
		const int left = span->x > first ? span->x : first;
		const int end = span->x + span->count <= last ? span->x + span->count : last + 1;
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
			count[x] = (uint8_t)(count[x] + (raw[x] != RAW_EMPTY));
	}
}

/* Sums the rows around a row, each column by itself. */
static void sum_columns(struct people *p, int y)
{
	for (int c = 0; c < 3; c++)
		for (int n = 0; n < 3; n++)
			memset(p->column[c][n] - AROUND, 0,
			       (size_t)(p->across + 2 * AROUND) * sizeof(float));
	memset(p->count - AROUND, 0, (size_t)p->across + 2 * AROUND);
	for (int v = y - AROUND; v <= y + AROUND; v++)
		if (v >= 0 && v < p->down && p->last_differs[v] >= 0)
			add_row(p, v);
}

static float sum_around(const struct people *p, int c, int n, int x)
{
	const float *sum = p->column[c][n] + x;

	return sum[-2] + sum[-1] + sum[0] + sum[1] + sum[2];
}

/* Whether what is seen around a cell of the summed row is the place in other light. */
static bool is_place_in_other_light(const struct people *p, int x, int cells)
{
	float low = INFINITY, high = 0;

	for (int c = 0; c < 3; c++) {
		const float ss = sum_around(p, c, 0, x), sp = sum_around(p, c, 1, x);
		const float pp = sum_around(p, c, 2, x), ratio = pp > 0 ? sp / pp : 0;

		if (ss - ratio * sp > EXPLAINED * (float)cells)
			return false;
		low = fminf(low, ratio);
		high = fmaxf(high, ratio);
	}
	return low >= DARKEST && high <= BRIGHTEST && high <= SAME_COLOUR * low;
}

/* How many cells around differ. */
static int count_around(const struct people *p, int x)
{
	const uint8_t *count = p->count + x;

	return count[-2] + count[-1] + count[0] + count[1] + count[2];
}

static bool is_beside(const struct people *p, int x, int y)
{
	for (int v = y - 1; v <= y + 1; v++)
		for (int u = x - 1; u <= x + 1; u++) {
			const int there = v * p->across + u;

			if (v >= 0 && u >= 0 && v < p->down && u < p->across && p->watch[there] &&
			    (p->raw[there] == RAW_STRONG || p->order[there]))
				return true;
		}
	return false;
}

static void judge_differing(struct people *p, const struct span *span)
{
	const int row = span->y * p->across;

	for (int x = span->x; x < span->x + span->count; x++) {
		if (p->raw[row + x] == RAW_EMPTY)
			continue;
		if (is_place_in_other_light(p, x, count_around(p, x)))
			p->verdict[row + x] = VERDICT_SHADED;
		else if (p->raw[row + x] == RAW_STRONG || is_beside(p, x, span->y))
			p->verdict[row + x] = VERDICT_PERSON;
	}
}

void judge_cells(struct people *p)
{
	for (int y = 0; y < p->down; y++)
		p->last_differs[y] = -1;
	memset(p->verdict, VERDICT_EMPTY, (size_t)p->cells);
	for (int s = 0; s < p->span_count; s++)
		judge_span(p, &p->spans[s]);
	for (int y = 0; y < p->down; y++) {
		if (p->last_differs[y] < 0)
			continue;
		sum_columns(p, y);
		for (int s = p->row_span[y]; s < p->row_span[y + 1]; s++)
			judge_differing(p, &p->spans[s]);
	}
}
