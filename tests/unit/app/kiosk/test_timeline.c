/* SPDX-License-Identifier: MIT */
/* The pose that is shown at a time. */
#include <math.h>

#include "app/kiosk/timeline.h"
#include "hal/base/clock.h"
#include "tests/support/test.h"

static struct timeline begun(enum config_timeline kind, double rate, int count, int pose)
{
	const struct config_poses poses = {.timeline = kind, .rate = rate};
	struct timeline t;

	timeline_begin(&t, &poses, count, pose, 1000 * NS_PER_S);
	return t;
}

static void test_timeline_check(const struct timeline *t, double after_s, int pose, int next,
				double share)
{
	const struct timeline_place at =
		timeline_at(t, 1000 * NS_PER_S + (int64_t)llround(after_s * NS_PER_S));

	if (at.pose != pose || at.next != next || fabs(at.share - share) > 1e-6)
		fail_msg("after %g s: %d to %d by %.9f, expected %d to %d by %.9f", after_s,
			 at.pose, at.next, at.share, pose, next, share);
}

TEST("loops")
{
	const struct timeline t = begun(TIMELINE_LOOP, 12, 36, 0);
	const struct timeline from = begun(TIMELINE_LOOP, 2, 3, 2);

	test_timeline_check(&t, 0, 0, 1, 0);
	test_timeline_check(&t, 1 / 24.0, 0, 1, 0.5);
	test_timeline_check(&t, 1, 12, 13, 0);
	test_timeline_check(&t, 2.95, 35, 0, 0.4);
	test_timeline_check(&t, 3, 0, 1, 0);
	test_timeline_check(&from, 0.25, 2, 0, 0.5);
	test_timeline_check(&from, 0.5, 0, 1, 0);
}

TEST("swings")
{
	static const int poses[] = {0, 1, 2, 3, 2, 1, 0, 1};
	const struct timeline t = begun(TIMELINE_SWING, 1, 4, 0);
	const struct timeline two = begun(TIMELINE_SWING, 10, 2, 1);

	for (int k = 0; k < 7; k++)
		test_timeline_check(&t, k + 0.25, poses[k], poses[k + 1], 0.25);
	test_timeline_check(&two, 0.05, 1, 0, 0.5);
	test_timeline_check(&two, 0.15, 0, 1, 0.5);
}

TEST("one pose stays")
{
	for (int kind = TIMELINE_NONE; kind < TIMELINE_COUNT; kind++) {
		const struct timeline t = begun((enum config_timeline)kind, 12, 1, 0);

		test_timeline_check(&t, 0.5, 0, 0, 0);
		test_timeline_check(&t, 1e6, 0, 0, 0);
	}
}

TEST("none stays")
{
	const struct timeline t = begun(TIMELINE_NONE, 12, 36, 7);

	test_timeline_check(&t, 100, 7, 7, 0);
}

/* Late frames skip poses, and no error adds up, even over years. */
TEST("keeps time")
{
	const double year = 365.25 * 24 * 3600;
	const struct timeline t = begun(TIMELINE_LOOP, 12, 36, 0);
	const struct timeline slow = begun(TIMELINE_SWING, 0.001, 5, 0);

	test_timeline_check(&t, 10 * year, 0, 1,
			    0); /* whole seconds; a round of poses takes three */
	test_timeline_check(&t, 10 * year + 1.125, 13, 14, 0.5);
	test_timeline_check(&slow, 8e3 * 1e4 + 1500, 1, 2, 0.5);
}

TEST("time that goes back waits")
{
	const struct timeline t = begun(TIMELINE_LOOP, 12, 36, 5);

	test_timeline_check(&t, -100, 5, 6, 0);
	test_timeline_check(&t, 0.25, 8, 9, 0);
}
