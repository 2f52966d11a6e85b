/* SPDX-License-Identifier: MIT */
#include "hal/base/log_pace.h"

#include <stdio.h>
#include <string.h>

#include "hal/base/clock.h"

#define MINUTE_NS (60 * NS_PER_S)
#define HOUR_NS (60 * MINUTE_NS)

/* The place of this text, or else the place whose text came longest ago; that of a count which has
 * not been written only where all have one. */
static int find_place(const struct log_pace *pace, const char *text)
{
	int best = 0;

	for (int i = 0; i < LOG_PACE_TEXTS; i++) {
		const bool waits = pace->texts[i].counted > 0;
		const bool best_waits = pace->texts[best].counted > 0;

		if (!strncmp(pace->texts[i].text, text, LOG_PACE_TEXT_MAX - 1))
			return i;
		if (waits == best_waits ? pace->texts[i].last_ns < pace->texts[best].last_ns
					: best_waits)
			best = i;
	}
	return best;
}

bool log_pace_take(struct log_pace *pace, enum log_level level, const char *text, int64_t now_ns)
{
	const int i = find_place(pace, text);
	const bool known = !strncmp(pace->texts[i].text, text, LOG_PACE_TEXT_MAX - 1);

	if (!known || (!pace->texts[i].counted && now_ns - pace->texts[i].last_ns >= HOUR_NS)) {
		snprintf(pace->texts[i].text, LOG_PACE_TEXT_MAX, "%s", text);
		pace->texts[i].written = pace->texts[i].counted = 0;
		pace->texts[i].span_ns = MINUTE_NS;
	}
	pace->texts[i].level = level;
	pace->texts[i].last_ns = now_ns;
	if (pace->texts[i].written < LOG_PACE_FIRST) {
		pace->texts[i].written++;
		pace->texts[i].begun_ns = now_ns;
		return true;
	}
	pace->texts[i].counted++;
	return false;
}

bool log_pace_due(struct log_pace *pace, int64_t now_ns, enum log_level *level,
		  char line[LOG_PACE_TEXT_MAX + 64])
{
	int due = -1;
	int64_t seconds;

	for (int i = 0; i < LOG_PACE_TEXTS; i++) {
		const bool over = now_ns - pace->texts[i].begun_ns >= pace->texts[i].span_ns ||
				  now_ns - pace->texts[i].last_ns >= MINUTE_NS;

		if (pace->texts[i].counted && over &&
		    (due < 0 || pace->texts[i].last_ns < pace->texts[due].last_ns))
			due = i;
	}
	if (due < 0)
		return false;
	seconds = (now_ns - pace->texts[due].begun_ns) / NS_PER_S;
	*level = pace->texts[due].level;
	snprintf(line, LOG_PACE_TEXT_MAX + 64, "%s (%u time%s more in the last %lld %s)",
		 pace->texts[due].text, pace->texts[due].counted,
		 pace->texts[due].counted == 1 ? "" : "s",
		 (long long)(seconds < 120 ? seconds : seconds / 60), seconds < 120 ? "s" : "min");
	pace->texts[due].counted = 0;
	pace->texts[due].begun_ns = now_ns;
	if (pace->texts[due].span_ns < HOUR_NS)
		pace->texts[due].span_ns = 2 * pace->texts[due].span_ns < HOUR_NS
						   ? 2 * pace->texts[due].span_ns
						   : HOUR_NS;
	return true;
}
