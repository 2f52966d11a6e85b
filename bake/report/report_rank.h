/* SPDX-License-Identifier: MIT */
/* Ranks choices by error and time, and says which ones cannot be told apart. */
#ifndef INLAY_BAKE_REPORT_REPORT_RANK_H
#define INLAY_BAKE_REPORT_REPORT_RANK_H

#include <stdbool.h>

struct report_result {
	double ms, ms_low, ms_high; /* time of a frame: median and quartiles */
	double rms;		    /* error, in levels */
	double noise; /* the square of an error may be off by noise^2 without being seen or known */
};

/*
 * a is faster than b: their quartiles do not overlap, and the medians differ by more than 5 %.
 */
bool report_is_faster(const struct report_result *a, const struct report_result *b);

/*
 * a is nearer than b. Noise adds to an error by squares, so errors whose squares differ by no more
 * than the square of the noise (the larger one of both) are equal:
 *     b.rms^2 - a.rms^2 > max(a.noise, b.noise)^2   and   b.rms > 1.01 a.rms
 */
bool report_is_nearer(const struct report_result *a, const struct report_result *b);

/* No other choice is better than this one in time or error without being worse in the other. */
bool report_is_front(const struct report_result *results, int count, int which);

/*
 * Chooses by error, then by time, then by order: sets near[k] of those choices than which no other
 * is nearer; returns the first of these than which no other of these is faster. -1: count is 0.
 */
int report_choose(const struct report_result *results, int count, bool *near);

#endif
