/* SPDX-License-Identifier: MIT */
/* How far long work has come: a bar that is redrawn on a terminal, a plain line every ten seconds
 * elsewhere; on stderr. Calls must not overlap. */
#ifndef INLAY_BAKE_BASE_PROGRESS_H
#define INLAY_BAKE_BASE_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

struct progress {
	const char *what;
	int total;
	bool quiet, terminal;
	int64_t start_ns, shown_ns;
};

void progress_begin(struct progress *progress, const char *what, int total, bool quiet);
void progress_show(struct progress *progress, int done, uint64_t rays);
double progress_end(struct progress *progress); /* takes the bar away; seconds since the start */

#endif
