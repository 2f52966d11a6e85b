/* SPDX-License-Identifier: MIT */
/* Progress of long work on stderr: a bar that is redrawn on a terminal, a plain line every ten
 * seconds elsewhere. Calls must not overlap. */
#ifndef INLAY_BAKE_BASE_PROGRESS_H
#define INLAY_BAKE_BASE_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

struct progress {
	const char *what; /* name of the work; must outlive this */
	double total;	  /* work in any unit; may be corrected on the way */
	bool quiet, terminal;
	int64_t start_ns, shown_ns;
};

void progress_begin(struct progress *progress, const char *what, double total, bool quiet);
/* done: work so far, in the unit of total; rays: rays so far. The time left is
 *     seconds so far * (total - done) / done
 * Most calls print nothing. */
void progress_show(struct progress *progress, double done, uint64_t rays);
/* Takes the bar away. Returns the seconds since progress_begin(). */
double progress_end(struct progress *progress);

#endif
