/* SPDX-License-Identifier: MIT */
/* Hours of the week: each case is the hours that are on, written minute by minute by hand. */
#include <errno.h>
#include <string.h>

#include "config/config_hours.h"
#include "tests/support/test.h"

enum { SUN, MON, TUE, WED, THU, FRI, SAT };

static int at(int day, int hour, int minute)
{
	return day * HOURS_DAY + hour * 60 + minute;
}

/* What is on, from - to to in minutes of the week. The end may lie beyond the week. */
struct span {
	int from, to;
};

static void check_hours(const char *text, const struct span *spans, size_t count)
{
	struct config_hours hours;
	struct fault why = {.text = ""};

	if (config_hours_read(text, &hours, &why))
		fail_msg("\"%s\" %s", text, why.text);
	for (int minute = 0; minute < HOURS_WEEK; minute++) {
		bool on = false;

		for (size_t i = 0; i < count; i++)
			on |= (minute >= spans[i].from && minute < spans[i].to) ||
			      minute + HOURS_WEEK < spans[i].to;
		if (config_hours_are_on(&hours, minute) != on)
			fail_msg("\"%s\": minute %d is %s", text, minute, on ? "off" : "on");
	}
}

#define CHECK_HOURS(text, ...)                                                                     \
	do {                                                                                       \
		const struct span spans[] = {__VA_ARGS__};                                         \
		check_hours(text, spans, sizeof(spans) / sizeof(*spans));                          \
	} while (0)

TEST("hours are read")
{
	CHECK_HOURS("", {0, HOURS_WEEK});
	CHECK_HOURS("0:00-24:00", {0, HOURS_WEEK});
	CHECK_HOURS("09:00-18:30", {at(SUN, 9, 0), at(SUN, 18, 30)},
		    {at(MON, 9, 0), at(MON, 18, 30)}, {at(TUE, 9, 0), at(TUE, 18, 30)},
		    {at(WED, 9, 0), at(WED, 18, 30)}, {at(THU, 9, 0), at(THU, 18, 30)},
		    {at(FRI, 9, 0), at(FRI, 18, 30)}, {at(SAT, 9, 0), at(SAT, 18, 30)});
	CHECK_HOURS("mon-wed 09:00-18:30, sat 10:00-14:00", {at(MON, 9, 0), at(MON, 18, 30)},
		    {at(TUE, 9, 0), at(TUE, 18, 30)}, {at(WED, 9, 0), at(WED, 18, 30)},
		    {at(SAT, 10, 0), at(SAT, 14, 0)});
	/* The second range is of the same days. */
	CHECK_HOURS("Mon Thursday 9-12:30 ,13:30 - 18", {at(MON, 9, 0), at(MON, 12, 30)},
		    {at(MON, 13, 30), at(MON, 18, 0)}, {at(THU, 9, 0), at(THU, 12, 30)},
		    {at(THU, 13, 30), at(THU, 18, 0)});
	/* over midnight, and over the end of the week */
	CHECK_HOURS("fri-sat 20:00-02:00", {at(FRI, 20, 0), at(SAT, 2, 0)},
		    {at(SAT, 20, 0), at(SAT, 26, 0)});
	CHECK_HOURS("sat-sun 22:00-24:00", {at(SAT, 22, 0), at(SAT, 24, 0)},
		    {at(SUN, 22, 0), at(SUN, 24, 0)});
	CHECK_HOURS("tue 8:00-12:00, tue 11:00-13:00", {at(TUE, 8, 0), at(TUE, 13, 0)});
}

TEST("mistakes are named")
{
	static const struct {
		const char *text, *says;
	} cases[] = {
		{"9 to 5", "from \"to 5\" on, expected a range of hours"},
		{"09:00", "ends too early, expected a range of hours"},
		{"mon", "ends too early, expected a time of day"},
		{"mon-fri 9:00-25:00", "from \"25:00\" on, expected a time of day"},
		{"9:60-10:00", "from \"9:60-10:00\" on, expected a time of day"},
		{"9:5-10:00", "from \"9:5-10:00\" on, expected a time of day"},
		{"900-1800", "expected a time of day"},
		{"9:00-24:01", "expected a time of day"},
		{"mo 9:00-10:00", "expected a day like mon"},
		{"montag 9:00-10:00", "from \"montag 9:00-10:00\" on, expected a day"},
		{"mon-10:00", "expected a day"},
		{"9:00-10:00 mon", "from \"mon\" on, expected a comma"},
		{"9:00-10:00,", "ends too early"},
		{"9:00-9:00", "a range without any time, 9:00-9:00"},
		{"24:00-6:00", "a range without any time"},
		{"-1:00-6:00", "expected a time of day"},
	};
	struct config_hours hours;
	char many[600] = "0-1";

	for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
		struct fault why = {.text = ""};

		assert_int_equal(config_hours_read(cases[i].text, &hours, &why), -EINVAL);
		if (!strstr(why.text, cases[i].says))
			fail_msg("\"%s\" %s, expected: %s", cases[i].text, why.text, cases[i].says);
		assert_int_equal(config_hours_check(cases[i].text, &why), -EINVAL);
	}
	for (int i = 1; i < HOURS_RANGES_MAX; i++)
		strcat(many, ",0-1");
	assert_int_equal(config_hours_read(many, &hours, NULL), 0);
	strcat(many, ",0-1");
	assert_int_equal(config_hours_read(many, &hours, NULL), -EINVAL);
}

TEST("next is found")
{
	struct config_hours hours;
	char text[HOURS_MOMENT_MAX];

	assert_int_equal(config_hours_read("mon-fri 9-18, fri 20-2", &hours, NULL), 0);
	assert_int_equal(config_hours_next(&hours, at(SUN, 0, 0)), at(MON, 9, 0));
	assert_int_equal(config_hours_next(&hours, at(MON, 9, 0)), at(MON, 18, 0));
	assert_int_equal(config_hours_next(&hours, at(FRI, 23, 59)), at(SAT, 2, 0));
	assert_int_equal(config_hours_next(&hours, at(SAT, 2, 0)), at(MON, 9, 0));
	config_hours_moment(at(SAT, 2, 5), text);
	assert_string_equal(text, "sat 02:05");
	assert_int_equal(config_hours_read("", &hours, NULL), 0);
	assert_int_equal(config_hours_next(&hours, 0), -1);
}

TEST("zones are checked")
{
	static const char *const good[] = {"",	      "CET-1CEST,M3.5.0,M10.5.0/3",
					   "EST5EDT", "<+03>-3",
					   "UTC0",    "UTC",
					   "<+01>-1", "CET-1",
					   "PST8PDT", "Etc/GMT0"};
	static const char *const bad[] = {"Europe",    "Europe/Berln", "Berlin",    "CE-1",
					  "../passwd", "CET -1",       "UTC+1",	    "GMT-2",
					  "CET-1CEST", "WET0WEST",     "Etc/GMT+1", "Etc/GMT-14"};
	struct fault why;

	for (size_t i = 0; i < sizeof(good) / sizeof(*good); i++)
		if (config_zone_check(good[i], &why))
			fail_msg("\"%s\" is refused: %s", good[i], why.text);
	for (size_t i = 0; i < sizeof(bad) / sizeof(*bad); i++)
		if (!config_zone_check(bad[i], &why))
			fail_msg("\"%s\" is taken", bad[i]);
}
