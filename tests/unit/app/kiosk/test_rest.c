/* SPDX-License-Identifier: MIT */
/* When a kiosk rests, by a clock that is played. Times are given in UTC and checked by hand. */
#include <stdlib.h>

#include "app/kiosk/rest.h"
#include "hal/base/clock.h"
#include "tests/support/test.h"

#define BERLIN "CET-1CEST,M3.5.0,M10.5.0/3"
#define MINUTE 60
#define HOUR 3600

/* 2026-03-28 00:00 UTC is a Saturday; in Berlin summer time begins on the 29th at 01:00 UTC. */
#define SATURDAY ((time_t)1774656000)
#define SUNDAY (SATURDAY + 24 * HOUR)
/* 2026-10-25 00:00 UTC: summer time ends there at 01:00 UTC. */
#define OCTOBER ((time_t)1792886400)

static struct rest resting_by(const char *hours, const char *zone)
{
	struct rest rest = {.built = SATURDAY - 1000 * HOUR};

	setenv("TZ", zone, 1);
	rest_take_hours(&rest, hours);
	return rest;
}

static void check_rest(const struct rest *rest, time_t wall, bool rests)
{
	if (rest_is_due(rest, wall, 5 * NS_PER_S) != rests)
		fail_msg("at %lld it %s", (long long)wall, rests ? "does not rest" : "rests");
}

TEST("hours are kept")
{
	const struct rest rest = resting_by("sat 09:00-18:30", BERLIN);
	const struct rest always = resting_by("", BERLIN);

	check_rest(&rest, SATURDAY + 8 * HOUR - 1, true);
	check_rest(&rest, SATURDAY + 8 * HOUR, false);
	check_rest(&rest, SATURDAY + 17 * HOUR + 30 * MINUTE - 1, false);
	check_rest(&rest, SATURDAY + 17 * HOUR + 30 * MINUTE, true);
	check_rest(&rest, SUNDAY + 12 * HOUR, true);
	check_rest(&always, SUNDAY + 3 * HOUR, false);
}

/* Until the clock is set the screen is on, whatever hours its time would mean. */
TEST("a clock that is not set does not count")
{
	const struct rest rest = resting_by("sat 09:00-18:30", "UTC0");

	check_rest(&rest, 0, false);
	check_rest(&rest, 3 * HOUR, false);
	check_rest(&rest, rest.built - 1, false);
	check_rest(&rest, SUNDAY, true);		/* set by NTP */
	check_rest(&rest, 100, false);			/* and lost again */
	check_rest(&rest, SATURDAY + 10 * HOUR, false); /* a step back into the hours */
	check_rest(&rest, SATURDAY + 20 * HOUR, true);
	check_rest(&rest, SATURDAY + 18 * HOUR, false);
}

TEST("summer time moves hours")
{
	const struct rest day = resting_by("09:00-18:00", BERLIN);
	struct rest night;

	check_rest(&day, SATURDAY + 8 * HOUR - 1, true);
	check_rest(&day, SATURDAY + 8 * HOUR, false);
	check_rest(&day, SUNDAY + 7 * HOUR - 1, true);
	check_rest(&day, SUNDAY + 7 * HOUR, false);
	check_rest(&day, SUNDAY + 16 * HOUR, true);
	/* From 2:00 the clock goes to 3:00: hours that begin in between begin then. */
	night = resting_by("02:30-04:00", BERLIN);
	check_rest(&night, SUNDAY + HOUR - 1, true);
	check_rest(&night, SUNDAY + HOUR, false);
	check_rest(&night, SUNDAY + 2 * HOUR, true);
	/* The hour from 2:00 to 3:00 comes twice. */
	check_rest(&night, OCTOBER + 30 * MINUTE, false);
	check_rest(&night, OCTOBER + HOUR, true);
	check_rest(&night, OCTOBER + 90 * MINUTE, false);
}

TEST("a press wakes it for a while")
{
	struct rest rest = resting_by("sat 09:00-18:30", "UTC0");
	const int64_t while_ns = REST_WAKE_MINUTES * 60 * NS_PER_S;

	assert_true(rest_is_due(&rest, SUNDAY, NS_PER_S));
	rest.resting = true;
	rest.due = false;
	assert_true(rest_press(&rest, NS_PER_S));
	assert_true(rest.due);
	rest.resting = rest.due = false;
	assert_false(rest_is_due(&rest, SUNDAY, NS_PER_S));
	/* The clock on the wall may jump meanwhile. */
	assert_false(rest_is_due(&rest, SUNDAY + 100000 * HOUR, while_ns));
	/* Another press prolongs it. */
	assert_false(rest_press(&rest, while_ns));
	assert_false(rest_is_due(&rest, SUNDAY, while_ns + NS_PER_S));
	assert_true(rest_is_due(&rest, SUNDAY, 2 * while_ns));
	rest_press(&rest, 2 * while_ns);
	rest_take_hours(&rest, "sun 09:00-18:30"); /* a reload forgets it */
	assert_true(rest_is_due(&rest, SUNDAY, 2 * while_ns + 1));
	assert_false(rest_is_due(&rest, SUNDAY + 9 * HOUR, 2 * while_ns + 1));
}

TEST("what comes next is said")
{
	const struct rest rest = resting_by("mon-fri 09:00-18:30", BERLIN);
	const struct rest always = resting_by("", BERLIN);
	char text[HOURS_MOMENT_MAX];

	rest_next(&rest, SATURDAY, text);
	assert_string_equal(text, "mon 09:00");
	rest_next(&rest, SUNDAY + 31 * HOUR, text); /* Monday, 9:00 */
	assert_string_equal(text, "mon 18:30");
	rest_next(&rest, 0, text);
	assert_string_equal(text, "");
	rest_next(&always, SUNDAY, text);
	assert_string_equal(text, "");
}
