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
	/* Other threads work, too, so that the clock's time counts. Else processor time of the
	 * calling thread does: other programs interrupt a long run more often than a short one. */
	bool shared;
	/* Totals where they do not: clock time and processor time, added to. */
	int64_t timed_ns, ran_ns;
};

/* ms: [ways][repeat], in the order of turns. Returns 0, or what prepare() or run() returned. */
int turns_time(struct turns *turns, double *ms);

/* The least time, and the quartiles: half of the times are between low and high. */
struct turns_spread {
	double least, low, median, high;
};

/* Sorts ms and returns its spread. Between two times they are interpolated linearly. */
struct turns_spread turns_spread(double *ms, int count);

#endif
