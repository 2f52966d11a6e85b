/* SPDX-License-Identifier: MIT */
#include "hal/compositor/division.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* Number of frames that are measured before a new division. */
#define FRAMES 32
/* Largest factor by which one measurement changes the cost of a tile: the system may have delayed
 * the thread. */
#define CHANGE_MOST 2.0

static void division_divide(struct division *d)
{
	double all = 0, before = 0;
	int run = 0;

	for (int t = 0; t < d->tiles; t++)
		all += d->cost[t];
	for (int t = 0; t < d->tiles; t++) {
		/* Each run gets at least one tile and leaves one for each later run. */
		while (run < d->runs &&
		       (d->tiles - t == d->runs - run || before * d->runs >= all * run) &&
		       (run == 0 || d->first[run - 1] < t))
			d->first[run++] = t;
		before += d->cost[t];
	}
	d->first[d->runs] = d->tiles;
}

int division_create(struct division *d, int runs, int tiles, const double *cost)
{
	*d = (struct division){.runs = runs, .tiles = tiles};
	d->first = calloc((size_t)runs + 1, sizeof(*d->first));
	d->cost = calloc((size_t)tiles, sizeof(*d->cost));
	d->took_ns = calloc((size_t)runs, sizeof(*d->took_ns));
	if (!d->first || !d->cost || !d->took_ns) {
		division_free(d);
		return -ENOMEM;
	}
	memcpy(d->cost, cost, sizeof(*cost) * (size_t)tiles);
	division_divide(d);
	return 0;
}

void division_free(struct division *d)
{
	free(d->first);
	free(d->cost);
	free(d->took_ns);
	*d = (struct division){0};
}

void division_took(struct division *d, int run, int64_t ns)
{
	d->took_ns[run] += ns;
}

static double run_cost(const struct division *d, int run)
{
	double sum = 0;

	for (int t = d->first[run]; t < d->first[run + 1]; t++)
		sum += d->cost[t];
	return sum;
}

void division_settle(struct division *d)
{
	double all = 0, took = 0;

	if (d->runs < 2 || ++d->frames < FRAMES)
		return;
	for (int r = 0; r < d->runs; r++) {
		all += run_cost(d, r);
		took += (double)d->took_ns[r];
	}
	for (int r = 0; r < d->runs && took > 0 && all > 0; r++) {
		double change = (double)d->took_ns[r] / took * all / run_cost(d, r);

		change = change > CHANGE_MOST	    ? CHANGE_MOST
			 : change < 1 / CHANGE_MOST ? 1 / CHANGE_MOST
						    : change;
		for (int t = d->first[r]; t < d->first[r + 1]; t++)
			d->cost[t] *= change;
	}
	memset(d->took_ns, 0, sizeof(*d->took_ns) * (size_t)d->runs);
	d->frames = 0;
	division_divide(d);
}
