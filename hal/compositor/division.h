/* SPDX-License-Identifier: MIT */
/*
 * Divides the tiles of a picture into runs of about equal time, estimated from the times measured
 * in frames before. Private to hal/compositor.
 */
#ifndef INLAY_HAL_COMPOSITOR_DIVISION_H
#define INLAY_HAL_COMPOSITOR_DIVISION_H

#include <stdint.h>

struct division {
	int runs, tiles;
	int *first; /* [runs + 1]: first tile of each run; the last entry is `tiles` */
	/* private */
	double *cost;	  /* [tiles]: estimated time of each tile, in any unit */
	int64_t *took_ns; /* [runs]: time of each run since the last division */
	int frames;	  /* since the last division */
};

/* runs: 1..tiles. cost: first estimate for each tile, in any unit; copied. -ENOMEM. */
int division_create(struct division *division, int runs, int tiles, const double *cost);
void division_free(struct division *division); /* zeroed is fine */

/* Adds the time of a run in this frame. Threads may report different runs at the same time. */
void division_took(struct division *division, int run, int64_t ns);

/* Call after each frame: divides anew after every 32 frames. */
void division_settle(struct division *division);

#endif
