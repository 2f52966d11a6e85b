/* SPDX-License-Identifier: MIT */
/*
 * A picture's tiles, divided into runs that take about equal time, by what they took before.
 * Private to hal/compositor.
 */
#ifndef INLAY_HAL_COMPOSITOR_DIVISION_H
#define INLAY_HAL_COMPOSITOR_DIVISION_H

#include <stdint.h>

struct division {
	int runs, tiles;
	int *first; /* [runs + 1]: of each run; the last is the number of tiles */
	/* private */
	double *cost;	  /* [tiles]: what each is thought to take; any unit */
	int64_t *took_ns; /* [runs]: since they were divided */
	int frames;
};

/* runs 1..tiles. cost: of each tile, guessed; only how they compare counts. -ENOMEM. */
int division_create(struct division *division, int runs, int tiles, const double *cost);
void division_free(struct division *division); /* zeroed is fine */

/* What a run took this frame; each run by one thread at a time. */
void division_took(struct division *division, int run, int64_t ns);

/* After each frame: now and then divides anew. */
void division_settle(struct division *division);

#endif
