/* SPDX-License-Identifier: MIT */
#include "app/kiosk/timeline.h"

#include <math.h>

#include "hal/base/clock.h"

/* Steps of a whole round: from one pose to the next, back to the first. */
static double round_of(const struct timeline *t)
{
	if (t->kind == TIMELINE_SWING)
		return t->count > 1 ? 2 * (t->count - 1) : 1;
	return t->count;
}

void timeline_begin(struct timeline *t, const struct config_poses *poses, int count, int pose,
		    int64_t now_ns)
{
	*t = (struct timeline){
		.kind = (enum config_timeline)poses->timeline,
		.rate = poses->rate,
		.count = count,
		.since_ns = now_ns,
		.place = pose,
	};
}

/* The pose after a whole number of steps from pose 0. */
static int pose_of(const struct timeline *t, double step)
{
	const int at = (int)fmod(step, round_of(t));

	return t->kind == TIMELINE_SWING && at >= t->count ? 2 * (t->count - 1) - at : at;
}

struct timeline_place timeline_at(const struct timeline *t, int64_t now_ns)
{
	const int64_t gone_ns = now_ns > t->since_ns ? now_ns - t->since_ns : 0;
	struct timeline_place at = {.pose = (int)t->place, .next = (int)t->place};
	double steps, whole;

	if (t->kind == TIMELINE_NONE)
		return at;
	/* Whole seconds and the rest are multiplied apart, so that after years no pose is lost to
	 * rounding. */
	steps = fmod((double)(gone_ns / NS_PER_S) * t->rate, round_of(t)) +
		(double)(gone_ns % NS_PER_S) / NS_PER_S * t->rate + t->place;
	whole = floor(steps);
	at.pose = pose_of(t, whole);
	at.next = pose_of(t, whole + 1);
	at.share = steps - whole;
	return at;
}
