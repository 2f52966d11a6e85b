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

static float rate_in(const struct people *p, double ms)
{
	return (float)(p->step_ms / (p->step_ms + ms));
}

/* ---- what is seen ---- */

/* A person's shadow goes with him: it is followed slowly, and what was taken for the place in it
 * comes back at once. */
static void drift_span(struct people *p, const struct span *span, float leak)
{
	const int at = span->y * p->cells.across + span->x, count = span->count;
	const float light = rate_in(p, LIGHT_MS), shade = rate_in(p, SHADE_MS);
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
			const bool fits = known[x] & (whose[x] != WHOSE_PERSON) &
					  (place >= DIM * WHITE) & (seen[x] <= CLIPPED * WHITE);
			float is = drift[x] * (1 + (fits ? told : 0) * (most - 1));

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

/* Whether a channel of a cell follows what it shows. */
static bool follows(const struct people *p, int c, int at)
{
	return p->place.known[at] && p->verdict.of[at] != WHOSE_PERSON &&
	       p->place.expected[c][at] >= DIM * WHITE && p->cells.seen[c][at] <= CLIPPED * WHITE;
}

/* Nobody is in the cell, and its channels tell how bright it is. */
static bool is_seen(const struct people *p, int at)
{
	return p->verdict.of[at] == WHOSE_PLACE && follows(p, 0, at) && follows(p, 1, at) &&
	       follows(p, 2, at);
}

static void sum_tile(const struct people *p, int tx, int ty, struct ratios *tile)
{
	const int side = BASIS_TILE / p->cells.side;

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

static void add_ratios(struct ratios *to, const struct ratios *from, int sign)
{
	for (int c = 0; c < 3; c++)
		to->sum[c] += (float)sign * from->sum[c];
	to->count += sign * from->count;
}

/* Makes of each tile the sum over all that are not below it, nor right of it. */
static void sum_tiles(struct people *p)
{
	const int across = p->tiles_across + 1;

	for (int ty = 0; ty < p->tiles_down; ty++)
		for (int tx = 0; tx < p->tiles_across; tx++) {
			struct ratios *own = &p->place.ratios[(ty + 1) * across + tx + 1];

			*own = (struct ratios){.count = 0};
			sum_tile(p, tx, ty, own);
			add_ratios(own, own - 1, 1);
			add_ratios(own, own - across, 1);
			add_ratios(own, own - across - 1, -1);
		}
}

/* Sums over so many tiles around one that enough is seen. */
static struct ratios sum_around(const struct people *p, int tx, int ty)
{
	const int across = p->tiles_across + 1;
	struct ratios sum = {.count = 0};

	for (int around = 1; sum.count < CELLS && around <= AROUND; around++) {
		const int left = tx > around ? tx - around : 0;
		const int top = ty > around ? ty - around : 0;
		const int right = tx + around < across - 1 ? tx + around + 1 : across - 1;
		const int bottom = ty + around < p->tiles_down ? ty + around + 1 : p->tiles_down;

		sum = p->place.ratios[bottom * across + right];
		add_ratios(&sum, &p->place.ratios[top * across + right], -1);
		add_ratios(&sum, &p->place.ratios[bottom * across + left], -1);
		add_ratios(&sum, &p->place.ratios[top * across + left], 1);
	}
	return sum;
}

static void follow_cell(struct people *p, int at, const struct ratios *sum)
{
	const float rate = rate_in(p, LIGHT_MS);

	if (!p->place.known[at] || p->verdict.of[at] == WHOSE_PLACE)
		return;
	for (int c = 0; c < 3; c++)
		if (!follows(p, c, at))
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
	const struct box *box = &p->verdict.differing;
	const int side = BASIS_TILE / p->cells.side;

	if (box->right < 0)
		return;
	sum_tiles(p);
	for (int ty = box->top / side; ty <= box->bottom / side; ty++)
		for (int tx = box->left / side; tx <= box->right / side; tx++)
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
