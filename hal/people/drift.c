/* SPDX-License-Identifier: MIT */
/*
 * Each cell's drift follows within half a second what the light's model is off by. What is behind
 * people, or in their shadow, cannot be followed; but lamps move meanwhile, and it would come back
 * in a light that is not the place's. So its drift takes the factor that the cells around take in
 * which nobody is, 1 + rate (mean of seen / expected - 1).
 */
#include "hal/people/people_parts.h"

#define LIGHT_MS 470.0	/* in which a cell follows light */
#define SHADE_MS 3000.0 /* in which it follows a shadow */
#define LEAK_MS 30e3	/* in which drift is handed on to the coefficients */
#define DRIFT_MOST 3.0f /* and its inverse */
#define EACH 2		/* a row and column of so many is asked around a hidden cell */
#define CELLS 32	/* that many must be seen around a tile */
#define AROUND 5	/* tiles on each side, at most */

static float light_rate(const struct people *p)
{
	return (float)(p->step_ms / (p->step_ms + LIGHT_MS));
}

static float shade_rate(const struct people *p)
{
	return (float)(p->step_ms / (p->step_ms + SHADE_MS));
}

/* ---- what is seen ---- */

static float rate_of_cell(const struct people *p, int at, bool darker)
{
	const uint8_t whose = p->verdict.of[at];

	if (!p->place.known[at] || whose == WHOSE_PERSON)
		return 0;
	/* A person's shadow goes with him: it is followed slowly, and what was taken for the place
	 * in it comes back at once. */
	return whose == WHOSE_SHADOW && darker ? shade_rate(p) : light_rate(p);
}

static void drift_span(struct people *p, const struct span *span, float leak)
{
	const int at = span->y * p->cells.across + span->x, count = span->count;
	const float light = light_rate(p), shade = shade_rate(p);
	const uint8_t *known = p->place.known + at, *whose = p->verdict.of + at;

	for (int c = 0; c < 3; c++) {
		const float *restrict seen = p->cells.seen[c] + at;
		const float *restrict expected = p->place.expected[c] + at;
		const float shared = p->place.shared[c];
		float *restrict drift = p->place.drift[c] + at;

		for (int x = 0; x < count; x++) {
			const float place = expected[x], ratio = seen[x] * shared / (place + 1);
			const float most = ratio < 2 ? ratio : 2;
			const float in_shade = ratio < 1 ? shade : light;
			const float told = whose[x] == WHOSE_SHADOW ? in_shade : light;
			const bool follows = known[x] & (whose[x] != WHOSE_PERSON) &
					     (place >= DIM * WHITE) & (seen[x] <= CLIPPED * WHITE);
			float is = drift[x] * (1 + (follows ? told : 0) * (most - 1));

			is = is > 1 / DRIFT_MOST ? is : 1 / DRIFT_MOST;
			is = is < DRIFT_MOST ? is : DRIFT_MOST;
			drift[x] = is + (1 - is) * leak;
		}
	}
}

static void drift_cell(struct people *p, int c, int at, float factor)
{
	float *drift = &p->place.drift[c][at];
	const float is = *drift * factor;

	*drift = is < DRIFT_MOST ? is > 1 / DRIFT_MOST ? is : 1 / DRIFT_MOST : DRIFT_MOST;
}

/* ---- what is hidden ---- */

/* The rate at which a channel of a cell follows what it shows. */
static float rate_of(const struct people *p, int c, int at)
{
	const float seen = p->cells.seen[c][at], place = p->place.expected[c][at];

	return place < DIM * WHITE || seen > CLIPPED * WHITE ? 0
							     : rate_of_cell(p, at, seen < place);
}

/* Nobody is in the cell, and its channels tell how bright it is. */
static bool is_seen(const struct people *p, int at)
{
	return p->place.known[at] && p->verdict.of[at] == WHOSE_PLACE && rate_of(p, 0, at) > 0 &&
	       rate_of(p, 1, at) > 0 && rate_of(p, 2, at) > 0;
}

static void sum_tile(const struct people *p, int tx, int ty, struct ratios *tile)
{
	const int side = BASIS_TILE / p->cells.side;

	*tile = (struct ratios){.count = 0};
	for (int y = ty * side; y < (ty + 1) * side && y < p->cells.down; y += EACH)
		for (int x = tx * side; x < (tx + 1) * side && x < p->cells.across; x += EACH) {
			const int at = y * p->cells.across + x;

			if (!p->cells.watch[at] || !is_seen(p, at))
				continue;
			for (int c = 0; c < 3; c++)
				tile->sum[c] += p->cells.seen[c][at] / p->place.expected[c][at];
			tile->count++;
		}
}

/* Sums over so many tiles around one that enough is seen. */
static struct ratios sum_around(const struct people *p, int tx, int ty)
{
	struct ratios sum = {.count = 0};

	for (int around = 1; sum.count < CELLS && around <= AROUND; around++) {
		sum = (struct ratios){.count = 0};
		for (int y = ty - around; y <= ty + around; y++)
			for (int x = tx - around; x <= tx + around; x++) {
				const struct ratios *tile;

				if (x < 0 || y < 0 || x >= p->tiles_across || y >= p->tiles_down)
					continue;
				tile = &p->place.ratios[y * p->tiles_across + x];
				for (int c = 0; c < 3; c++)
					sum.sum[c] += tile->sum[c];
				sum.count += tile->count;
			}
	}
	return sum;
}

static void follow_cell(struct people *p, int at, const struct ratios *sum)
{
	const float rate = light_rate(p);

	if (!p->place.known[at] || p->verdict.of[at] == WHOSE_PLACE)
		return;
	for (int c = 0; c < 3; c++)
		if (rate_of(p, c, at) == 0)
			drift_cell(p, c, at, 1 + rate * (sum->sum[c] / (float)sum->count - 1));
}

static bool hides(const struct people *p, int tx, int ty)
{
	const int side = BASIS_TILE / p->cells.side;

	for (int y = ty * side; y < (ty + 1) * side && y < p->cells.down; y++)
		for (int x = tx * side; x < (tx + 1) * side && x < p->cells.across; x++)
			if (p->verdict.of[y * p->cells.across + x] != WHOSE_PLACE)
				return true;
	return false;
}

static void follow_tile(struct people *p, int tx, int ty)
{
	const struct ratios sum = sum_around(p, tx, ty);
	const int side = BASIS_TILE / p->cells.side;

	if (sum.count < CELLS)
		return;
	for (int y = ty * side; y < (ty + 1) * side && y < p->cells.down; y++)
		for (int x = tx * side; x < (tx + 1) * side && x < p->cells.across; x++)
			follow_cell(p, y * p->cells.across + x, &sum);
}

static void follow_hidden(struct people *p)
{
	if (p->verdict.differing.right < 0)
		return;
	for (int ty = 0; ty < p->tiles_down; ty++)
		for (int tx = 0; tx < p->tiles_across; tx++)
			sum_tile(p, tx, ty, &p->place.ratios[ty * p->tiles_across + tx]);
	for (int ty = 0; ty < p->tiles_down; ty++)
		for (int tx = 0; tx < p->tiles_across; tx++)
			if (hides(p, tx, ty))
				follow_tile(p, tx, ty);
}

void drift_follow(struct people *p)
{
	const float leak = (float)(p->step_ms / LEAK_MS);

	follow_hidden(p);
	for (int s = 0; s < p->cells.span_count; s++)
		drift_span(p, &p->cells.spans[s], leak);
}
