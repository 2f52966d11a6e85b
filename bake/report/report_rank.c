/* SPDX-License-Identifier: MIT */
#include "bake/report/report_rank.h"

#include <math.h>
#include <stddef.h>

/* Errors and times closer to each other than these factors count as equal. */
#define SAME_RMS 1.01
#define SAME_MS 1.05

bool report_is_faster(const struct report_result *a, const struct report_result *b)
{
	return a->ms_high < b->ms_low && a->ms * SAME_MS < b->ms;
}

bool report_is_nearer(const struct report_result *a, const struct report_result *b)
{
	const double noise = fmax(a->noise, b->noise);

	return a->rms * SAME_RMS < b->rms && b->rms * b->rms - a->rms * a->rms > noise * noise;
}

bool report_is_front(const struct report_result *results, int count, int which)
{
	const struct report_result *c = &results[which];

	for (int k = 0; k < count; k++) {
		const struct report_result *other = &results[k];
		const bool faster = report_is_faster(other, c), nearer = report_is_nearer(other, c);

		if ((faster && !report_is_nearer(c, other)) ||
		    (nearer && !report_is_faster(c, other)))
			return false;
	}
	return true;
}

static bool is_beaten(const struct report_result *results, int count, const bool *among, int which,
		      bool (*beats)(const struct report_result *, const struct report_result *))
{
	for (int k = 0; k < count; k++)
		if ((!among || among[k]) && beats(&results[k], &results[which]))
			return true;
	return false;
}

int report_choose(const struct report_result *results, int count, bool *near)
{
	for (int k = 0; k < count; k++)
		near[k] = !is_beaten(results, count, NULL, k, report_is_nearer);
	for (int k = 0; k < count; k++)
		if (near[k] && !is_beaten(results, count, near, k, report_is_faster))
			return k;
	return -1;
}
