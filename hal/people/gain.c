/* SPDX-License-Identifier: MIT */
/*
 * The camera's exposure, over that when learning began. It changes all cells alike, so half of
 * seen / place lies close together. Where it does not, something hides the place, and the exposure
 * of before is kept. place.c keeps what all cells share out of the place, but for a part of a gain
 * that lasts: a switched lamp that the terms do not tell looks like an exposure, and so gain and
 * place cannot wander against each other: the gain comes back to 1.
 */
#include <math.h>

#include "hal/people/people_parts.h"

#define CELLS_ASKED 2000
#define CELLS_LEAST 100
#define SCATTER 0.15f  /* width of the densest half of ratios, over their middle */
#define BINS 2048      /* of seen / place, 0..4 */
#define DARKEST 0.004f /* of white */

/* Mean ratio of bins from..to. */
static float mean_ratio(const int bins[BINS], int from, int to)
{
	float sum = 0, count = 0;

	for (int b = from; b <= to; b++) {
		sum += (float)bins[b] * ((float)b + 0.5f);
		count += (float)bins[b];
	}
	return sum / count * (4.0f / BINS);
}

/* The gain where the narrowest stretch of bins holds half of the cells; `gain`: there is none. */
static float densest(const int bins[BINS], int count, float gain)
{
	float narrowest = SCATTER;
	int held = 0, from = 0, best_from = 0, best_to = -1;

	for (int to = 0; to < BINS; to++) {
		for (held += bins[to]; 2 * (held - bins[from]) >= count; from++)
			held -= bins[from];
		const float wide = (float)(to + 1 - from) / (0.5f * (float)(to + 1 + from));

		if (2 * held >= count && wide < narrowest) {
			narrowest = wide;
			best_from = from;
			best_to = to;
		}
	}
	return best_to < 0 ? gain
			   : fminf(fmaxf(mean_ratio(bins, best_from, best_to), 0.125f), 3.9f);
}

static void follow_channel(struct people *p, int c)
{
	const float light = p->place.light[c][0], *seen = p->cells.seen[c];
	const int step = p->cells.watched / CELLS_ASKED + 1;
	int bins[BINS] = {0}, count = 0;

	for (int s = 0; s < p->cells.span_count; s++) {
		const struct span *span = &p->cells.spans[s];

		for (int x = span->x + span->y % step; x < span->x + span->count; x += step) {
			const int at = span->y * p->cells.across + x;
			const float place = p->place.lit[c][at] * p->place.drift[c][at] * light;
			float ratio;

			if (!p->place.known[at] || p->verdict.of[at] == WHOSE_PERSON ||
			    place < DARKEST * WHITE || seen[at] > CLIPPED * WHITE)
				continue;
			ratio = seen[at] / place * (BINS / 4.0f);
			bins[ratio < BINS - 1 ? (int)ratio : BINS - 1]++;
			count++;
		}
	}
	if (count > CELLS_LEAST)
		p->place.gain[c] = densest(bins, count, p->place.gain[c]);
}

static void expose_span(struct people *p, const struct span *span, int c)
{
	const int at = span->y * p->cells.across + span->x, count = span->count;
	const float *restrict lit = p->place.lit[c] + at, *restrict drift = p->place.drift[c] + at;
	const float exposure = p->place.light[c][0] * p->place.gain[c];
	float *restrict expected = p->place.expected[c] + at;

	for (int x = 0; x < count; x++) {
		const float exposed = lit[x] * drift[x] * exposure;

		expected[x] = exposed < WHITE ? exposed : WHITE;
	}
}

/* Measures what all cells are off by, which gain could not take. */
static void measure_shared(struct people *p, int c)
{
	const float *seen = p->cells.seen[c], *expected = p->place.expected[c];
	const int step = p->cells.watched / CELLS_ASKED + 1;
	float all_seen = 0, all_expected = 0;

	for (int s = 0; s < p->cells.span_count; s++) {
		const struct span *span = &p->cells.spans[s];
		const int row = span->y * p->cells.across;

		for (int x = span->x + span->y % step; x < span->x + span->count; x += step)
			if (p->place.known[row + x] && p->verdict.of[row + x] == WHOSE_PLACE &&
			    fabsf(seen[row + x] - expected[row + x]) <
				    SCATTER * expected[row + x] &&
			    seen[row + x] <= CLIPPED * WHITE) {
				all_seen += seen[row + x];
				all_expected += expected[row + x];
			}
	}
	p->place.shared[c] = all_seen > 0 ? all_expected / all_seen : 1;
}

void gain_follow(struct people *p)
{
	for (int c = 0; c < 3; c++) {
		follow_channel(p, c);
		for (int s = 0; s < p->cells.span_count; s++)
			expose_span(p, &p->cells.spans[s], c);
		measure_shared(p, c);
	}
}
