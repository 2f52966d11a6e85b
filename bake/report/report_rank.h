/* SPDX-License-Identifier: MIT */
/* Says which choices are better than others in error or time, and which cannot be told apart. */
#ifndef INLAY_BAKE_REPORT_REPORT_RANK_H
#define INLAY_BAKE_REPORT_REPORT_RANK_H

#include <stdbool.h>

struct report_result {
	double ms, ms_low, ms_high; /* time of a frame: median and quartiles */
	double rms;		    /* error, in levels */
};

/*
 * No other choice is better than this one in time or error without being worse in the other.
 *     faster:  a.ms_high < b.ms_low                 and  1.05 a.ms < b.ms
 *     nearer:  b.rms^2 - a.rms^2 > noise^2          and  1.01 a.rms < b.rms
 * Noise adds to an error by squares.
 */
bool report_is_front(const struct report_result *results, int count, int which, double noise);

#endif
