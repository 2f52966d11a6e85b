/* SPDX-License-Identifier: MIT */
#include "bake/report/report_rank.h"

/* Errors and times closer to each other than these factors count as equal. */
#define SAME_RMS 1.01
#define SAME_MS 1.05

static bool is_faster(const struct report_result *a, const struct report_result *b)
{
	return a->ms_high < b->ms_low && a->ms * SAME_MS < b->ms;
}

static bool is_nearer(const struct report_result *a, const struct report_result *b, double noise)
{
	return a->rms * SAME_RMS < b->rms && b->rms * b->rms - a->rms * a->rms > noise * noise;
}

bool report_is_front(const struct report_result *results, int count, int which, double noise)
{
	const struct report_result *c = &results[which];

	for (int k = 0; k < count; k++) {
		const struct report_result *other = &results[k];
		const bool faster = is_faster(other, c), nearer = is_nearer(other, c, noise);

		if ((faster && !is_nearer(c, other, noise)) || (nearer && !is_faster(c, other)))
			return false;
	}
	return true;
}
