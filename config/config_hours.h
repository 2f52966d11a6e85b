/* SPDX-License-Identifier: MIT */
/*
 * Hours of the week at which a screen is on, as [screen] hours says them:
 *
 *     09:00-18:30                                    every day
 *     mon-fri 09:00-12:30, 13:30-18:30, sat 10-14    ranges without a day are of the days before
 *     mon wed 18:00-02:00                            over midnight: it belongs to the day it begins
 *
 * All times are of the clock on the wall: which ones those are on a day of summer time does not
 * matter here.
 */
#ifndef INLAY_CONFIG_CONFIG_HOURS_H
#define INLAY_CONFIG_CONFIG_HOURS_H

#include <stdbool.h>
#include <time.h>

#include "hal/base/fault.h"

#define HOURS_RANGES_MAX 32
#define HOURS_DAY 1440		   /* minutes */
#define HOURS_WEEK (7 * HOURS_DAY) /* minutes; minute 0 is Sunday's first, as in struct tm */
#define HOURS_MOMENT_MAX sizeof("mon 09:00")

struct config_hours {
	int count; /* ranges; 0: always on */
	struct {
		unsigned days;	/* bit d: begins on day d, 0 is Sunday */
		int begin, end; /* minutes since the day's midnight; end may lie in the next day */
	} ranges[HOURS_RANGES_MAX];
};

/* Empty text: always on. 0, or -EINVAL with what is wrong and what was expected. */
int config_hours_read(const char *text, struct config_hours *hours, struct fault *why);

/* For struct ini_key: whether config_hours_read() takes the text. */
int config_hours_check(const char *text, struct fault *why);

/* For struct ini_key: whether the C library knows this time zone, by its name or by POSIX's rules.
 * The library itself takes an unknown one for UTC without a word. */
int config_zone_check(const char *text, struct fault *why);

/* Whether the screen is on in this minute of the week. */
bool config_hours_are_on(const struct config_hours *hours, int minute);

/* Finds the next minute of the week at which it goes on or off. -1: it never does. */
int config_hours_next(const struct config_hours *hours, int minute);

/* Minute of the week by local time. Asks for the zone again, whose file may have changed. */
int config_hours_minute(time_t wall);

/* Writes a minute of the week: "mon 09:00". */
void config_hours_moment(int minute, char text[HOURS_MOMENT_MAX]);

#endif
