/* SPDX-License-Identifier: MIT */
/* Messages that come again and again, by a clock that is played. */
#include <stdio.h>
#include <string.h>

#include "hal/base/clock.h"
#include "hal/base/log_pace.h"
#include "tests/support/test.h"

static struct log_pace pace;

static int start(void **state)
{
	(void)state;
	memset(&pace, 0, sizeof(pace));
	return 0;
}

static bool take(const char *text, int64_t second)
{
	return log_pace_take(&pace, LOG_LEVEL_WARNING, text, second * NS_PER_S);
}

/* A camera that comes and goes each second for ten hours: few lines, and none is lost. */
TEST_BETWEEN("ten hours are few lines", start, NULL)
{
	static const int expected_s[] = {63, 183, 423, 903, 1863, 3783, 7383, 10983, 14583};
	char line[LOG_PACE_TEXT_MAX + 64];
	enum log_level level;
	unsigned written = 0, counted = 0, counts = 0, times;
	size_t summaries = 0;

	for (int s = 0; s < 36000; s++) {
		written += take("camera c: unplugged", s);
		while (log_pace_due(&pace, s * NS_PER_S, &level, line)) {
			if (summaries < sizeof(expected_s) / sizeof(*expected_s) &&
			    s != expected_s[summaries])
				fail_msg("count %zu comes after %d s, expected %d", summaries, s,
					 expected_s[summaries]);
			summaries++;
			assert_int_equal(sscanf(line, "camera c: unplugged (%u times more", &times),
					 1);
			counted += times;
			counts++;
			assert_int_equal(level, LOG_LEVEL_WARNING);
			if (s == 63)
				assert_string_equal(
					line,
					"camera c: unplugged (60 times more in the last 60 s)");
			if (s == 10983)
				assert_string_equal(
					line,
					"camera c: unplugged (3600 times more in the last 60 min)");
		}
	}
	assert_int_equal(written, LOG_PACE_FIRST);
	assert_int_equal(counts, 14);
	/* It has ended: the rest is written a minute later. */
	assert_false(log_pace_due(&pace, 36058 * NS_PER_S, &level, line));
	assert_true(log_pace_due(&pace, 36059 * NS_PER_S, &level, line));
	assert_int_equal(sscanf(line, "camera c: unplugged (%u times more", &times), 1);
	assert_int_equal(written + counted + times, 36000);
	assert_false(log_pace_due(&pace, 40000 * NS_PER_S, &level, line));
}

/* What is written last is how it is. */
TEST_BETWEEN("the last state comes last", start, NULL)
{
	char line[LOG_PACE_TEXT_MAX + 64];
	enum log_level level;

	for (int s = 0; s < 10; s++) {
		take("fine again", 2 * s + 10);
		take("unplugged", 2 * s + 11);
	}
	assert_true(log_pace_due(&pace, 200 * NS_PER_S, &level, line));
	assert_non_null(strstr(line, "fine again (6 times more in the last 3 min)"));
	assert_true(log_pace_due(&pace, 200 * NS_PER_S, &level, line));
	assert_non_null(strstr(line, "unplugged (6 times"));
	assert_false(log_pace_due(&pace, 200 * NS_PER_S, &level, line));
}

TEST_BETWEEN("what is rare is written each time", start, NULL)
{
	for (int i = 0; i < 20; i++)
		assert_true(take("once an hour", i * 3600));
	for (int i = 0; i < LOG_PACE_FIRST; i++)
		assert_true(take("once an hour", 20 * 3600 + i));
	assert_false(take("once an hour", 20 * 3600 + 60));
	assert_true(take("another", 20 * 3600 + 60));
}

/* Whatever the number of texts, one that is counted is forgotten last. */
TEST_BETWEEN("many texts forget the oldest", start, NULL)
{
	char text[40], line[LOG_PACE_TEXT_MAX + 64];
	char longest[2 * LOG_PACE_TEXT_MAX];
	enum log_level level;

	for (int i = 0; i <= LOG_PACE_FIRST; i++)
		take("counted", i);
	for (int i = 0; i < 10 * LOG_PACE_TEXTS; i++) {
		snprintf(text, sizeof(text), "text %d", i);
		assert_true(take(text, 100 + i));
	}
	assert_true(log_pace_due(&pace, 700 * NS_PER_S, &level, line));
	assert_non_null(strstr(line, "counted (1 time more"));
	memset(longest, 'x', sizeof(longest) - 1);
	longest[sizeof(longest) - 1] = '\0';
	for (int i = 0; i < LOG_PACE_FIRST; i++)
		assert_true(take(longest, 1000 + i));
	assert_false(take(longest, 1010));
}
