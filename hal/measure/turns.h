/* SPDX-License-Identifier: MIT */
/*
 * Times several ways to do a thing in turns (A, B, C, A, B, C, ...), so that noise of the machine
 * meets all alike, each after some rounds of its own that are not timed, so that it finds caches as
 * it leaves them.
 */
#ifndef INLAY_HAL_MEASURE_TURNS_H
#define INLAY_HAL_MEASURE_TURNS_H

#include <stdbool.h>
#include <stdint.h>

struct turns {
	void *context;
	int ways, repeat;
	/* Untimed, before each run; what it or run returns other than 0 ends everything. */
	int (*prepare)(void *context, int way, int turn);
	int (*run)(void *context, int way);
	/* Whether the calling thread does all of it. Then what counts is the time that it had of
	 * the processor: by the clock a long way that has to make room for others would seem longer
	 * than a short one. */
	bool (*is_alone)(void *context, int way);
	/* Added to, by what the calling thread did alone: by the clock, and by the processor. */
	int64_t timed_ns, ran_ns;
};

/* ms: [ways][repeat], in the order of turns. */
int turns_time(struct turns *turns, double *ms);

/* Sorts them; of an even number the mean of the two in the middle. */
double turns_median(double *ms, int count);

#endif
