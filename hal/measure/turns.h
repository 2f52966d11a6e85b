/* SPDX-License-Identifier: MIT */
/*
 * Times several methods in turns (A, B, C, A, B, C, ...), so that noise of the machine affects all
 * equally. Untimed runs of the same method precede each timed one, so that it finds warm caches.
 */
#ifndef INLAY_HAL_MEASURE_TURNS_H
#define INLAY_HAL_MEASURE_TURNS_H

#include <stdbool.h>
#include <stdint.h>

struct turns {
	void *context;
	int ways, repeat;
	/* Called before each run, untimed. Anything but 0 from prepare() or run() ends all. */
	int (*prepare)(void *context, int way, int turn);
	int (*run)(void *context, int way);
	/* Whether the calling thread does all the work of a way; NULL: of all ways. If so, its
	 * processor time counts instead of the clock's: other programs interrupt a long run more
	 * often than a short one. */
	bool (*is_alone)(void *context, int way);
	/* Totals of these single-threaded runs: clock time and processor time, added to. */
	int64_t timed_ns, ran_ns;
};

/* ms: [ways][repeat], in the order of turns. Returns 0, or what prepare() or run() returned. */
int turns_time(struct turns *turns, double *ms);

/* Sorts ms and returns the median; for an even count the mean of the middle two. */
double turns_median(double *ms, int count);

/* Quartiles of times: half of the times are between low and high. */
struct turns_spread {
	double low, median, high;
};

/* Sorts ms and returns its quartiles. Between two times they are interpolated linearly. */
struct turns_spread turns_spread(double *ms, int count);

#endif
