/* SPDX-License-Identifier: MIT */
/*
 * What hides behind people, or lies in their shadow, cannot be followed; but lamps move meanwhile,
 * and it would come back in a light that is not the place's. So its drift takes the factor that the
 * cells around take in which nobody is, 1 + rate (mean of seen / place - 1).
 */
#include "hal/people/people_parts.h"


#define EACH 2	 /* a row and column of so many is asked */
#define CELLS 32 /* that many must be seen around a tile */
#define AROUND 5 /* tiles on each side, at most */

/* The rate at which a channel of a cell follows what it shows. */
static float rate_of(const struct people *p, int c, int at)
{
	const float seen = p->cells.seen[c][at], place = p->place.expected[c][at];

	return place < DIM * WHITE || seen > CLIPPED * WHITE ? 0
							     : place_rate(p, at, seen < place);
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
	const float rate = p->place.jumped ? 1 : place_light_rate(p);

	if (!p->place.known[at] || (p->verdict.of[at] == WHOSE_PLACE && !p->place.jumped))
		return;
	for (int c = 0; c < 3; c++)
		if (p->place.jumped || rate_of(p, c, at) == 0)
			place_drift(p, c, at, 1 + rate * (sum->sum[c] / (float)sum->count - 1));
}

static bool hides(const struct people *p, int tx, int ty)
{
	const int side = BASIS_TILE / p->cells.side;

	for (int y = ty * side; y < (ty + 1) * side && y < p->cells.down; y++)
		for (int x = tx * side; x < (tx + 1) * side && x < p->cells.across; x++)
			if (p->verdict.of[y * p->cells.across + x] != WHOSE_PLACE)
				return true;
	return p->place.jumped;
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

void hidden_follow(struct people *p)
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
