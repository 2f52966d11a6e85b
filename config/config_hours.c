/* SPDX-License-Identifier: MIT */
#include "config/config_hours.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "hal/ini/ini.h"

#define ZONES "/usr/share/zoneinfo/"
#define EVERY_DAY 0x7fU

static const char *const day_names[7] = {"sunday",   "monday", "tuesday", "wednesday",
					 "thursday", "friday", "saturday"};

/* The text that is read; at moves on over what was understood. */
struct reading {
	const char *at;
	struct config_hours *hours;
};

static void skip_blanks(struct reading *r)
{
	r->at += strspn(r->at, " \t");
}

static int say_odd(const struct reading *r, const char *expected, struct fault *why)
{
	if (!*r->at)
		return fault_say(why, -EINVAL, "ends too early, expected %s", expected);
	return fault_say(why, -EINVAL, "is not understood from \"%.40s\" on, expected %s", r->at,
			 expected);
}

/* Takes a word that names a day by its first three letters or more. -1: it names none, and
 * nothing is taken. */
static int take_day(struct reading *r)
{
	size_t length = 0;

	while (isalpha((unsigned char)r->at[length]))
		length++;
	for (int day = 0; day < 7 && length >= 3; day++) {
		if (length > strlen(day_names[day]) || strncasecmp(r->at, day_names[day], length))
			continue;
		r->at += length;
		return day;
	}
	return -1;
}

/* Takes days: "mon", "mon-fri", "sat-mon", several with blanks between. */
static int take_days(struct reading *r, unsigned *days, struct fault *why)
{
	*days = 0;
	for (skip_blanks(r); isalpha((unsigned char)*r->at); skip_blanks(r)) {
		const int first = take_day(r);
		int last = first;

		if (first >= 0 && *r->at == '-') {
			r->at++;
			last = take_day(r);
		}
		if (first < 0 || last < 0)
			return say_odd(r, "a day like mon or sunday", why);
		for (int day = first; day != last; day = (day + 1) % 7)
			*days |= 1U << day;
		*days |= 1U << last;
	}
	return 0;
}

/* Takes one or two digits. -1: there are none, or more. */
static int take_number(struct reading *r)
{
	int value = 0, digits = 0;

	for (; isdigit((unsigned char)*r->at) && digits < 3; digits++)
		value = 10 * value + *r->at++ - '0';
	return digits == 1 || digits == 2 ? value : -1;
}

/* Takes a time of day, "9", "09:00" or "24:00", in minutes. */
static int take_time(struct reading *r, int *minutes, struct fault *why)
{
	const char *begin = r->at;
	const int hour = take_number(r);
	int minute = 0;

	if (hour >= 0 && *r->at == ':') {
		const char *colon = r->at++;

		minute = take_number(r);
		if (r->at != colon + 3)
			minute = -1;
	}
	*minutes = 60 * hour + minute;
	if (hour >= 0 && minute >= 0 && minute < 60 && *minutes <= HOURS_DAY)
		return 0;
	r->at = begin;
	return say_odd(r, "a time of day 0:00 to 24:00", why);
}

static int take_range(struct reading *r, unsigned days, struct fault *why)
{
	struct config_hours *hours = r->hours;
	int begin, end, err;

	skip_blanks(r);
	err = take_time(r, &begin, why);
	if (err)
		return err;
	skip_blanks(r);
	if (*r->at != '-')
		return say_odd(r, "a range of hours like 09:00-18:30", why);
	r->at++;
	skip_blanks(r);
	err = take_time(r, &end, why);
	if (err)
		return err;
	if (begin == HOURS_DAY || begin == end)
		return fault_say(
			why, -EINVAL,
			"holds a range without any time, %d:%02d-%d:%02d, expected one like 09:00-18:30 (all day is 0:00-24:00)",
			begin / 60, begin % 60, end / 60, end % 60);
	if (hours->count == HOURS_RANGES_MAX)
		return fault_say(why, -EINVAL, "holds too many ranges, expected at most %d",
				 HOURS_RANGES_MAX);
	hours->ranges[hours->count].days = days;
	hours->ranges[hours->count].begin = begin;
	hours->ranges[hours->count++].end = end > begin ? end : end + HOURS_DAY;
	return 0;
}

int config_hours_read(const char *text, struct config_hours *hours, struct fault *why)
{
	struct reading r = {.at = text, .hours = hours};
	unsigned days = EVERY_DAY;

	hours->count = 0;
	skip_blanks(&r);
	if (!*r.at)
		return 0;
	for (;;) {
		unsigned named;
		int err = take_days(&r, &named, why);

		days = named ? named : days;
		if (!err)
			err = take_range(&r, days, why);
		if (err)
			return err;
		skip_blanks(&r);
		if (!*r.at)
			return 0;
		if (*r.at != ',')
			return say_odd(&r, "a comma and the next range", why);
		r.at++;
	}
}

int config_hours_check(const char *text, struct fault *why)
{
	struct config_hours hours;

	return config_hours_read(text, &hours, why);
}

/* Refuses what means the opposite of what it seems to: POSIX counts hours west of Greenwich as
 * positive, and so do the names of Etc. */
static int check_greenwich(const char *text, const char *rules, struct fault *why)
{
	const bool greenwich = !strncmp(rules, "UTC", 3) || !strncmp(rules, "GMT", 3);
	const long west = greenwich ? strtol(rules + 3, NULL, 10) : 0;

	if (!west)
		return 0;
	return fault_say(
		why, -EINVAL,
		"is \"%.60s\", which by POSIX means %ld h %s Greenwich; expected a place like Europe/Berlin, or for that very time <%+03ld>%ld",
		text, labs(west), west > 0 ? "behind" : "ahead of", -west, west);
}

/* Refuses summer time without dates: the C library adds the American ones, which are right in
 * America only. */
static int check_rules(const char *text, size_t letters, struct fault *why)
{
	char *end;
	const long west = strtol(text + letters, &end, 10);

	if (isalpha((unsigned char)*end) && !strchr(end, ',') && (west < 3 || west > 10))
		return fault_say(
			why, -EINVAL,
			"is \"%.60s\", whose summer time has no dates (American ones would be taken), expected them too, as in CET-1CEST,M3.5.0,M10.5.0/3",
			text);
	return 0;
}

int config_zone_check(const char *text, struct fault *why)
{
	char path[sizeof(ZONES) + INI_TEXT_MAX];
	struct stat file;
	size_t letters = 0;
	int err = check_greenwich(text, strncmp(text, "Etc/", 4) ? text : text + 4, why);

	if (err)
		return err;
	while (isalpha((unsigned char)text[letters]))
		letters++;
	snprintf(path, sizeof(path), ZONES "%s", text);
	if (!*text || !strcmp(text, "UTC") || (stat(path, &file) == 0 && S_ISREG(file.st_mode)))
		return 0;
	if (!strpbrk(text, " \t") &&
	    (*text == '<' || (letters >= 3 && strspn(text + letters, "+-0123456789"))))
		return check_rules(text, letters, why);
	return fault_say(
		why, -EINVAL,
		"is \"%.60s\", which is no time zone of this system, expected one like Europe/Berlin or CET-1CEST,M3.5.0,M10.5.0/3",
		text);
}

bool config_hours_are_on(const struct config_hours *hours, int minute)
{
	for (int i = 0; i < hours->count; i++)
		for (int day = 0; day < 7; day++) {
			/* Minutes since the range's own midnight, which may be last week's. */
			const int since = (minute - day * HOURS_DAY + HOURS_WEEK) % HOURS_WEEK;

			if (hours->ranges[i].days >> day & 1 && since >= hours->ranges[i].begin &&
			    since < hours->ranges[i].end)
				return true;
		}
	return !hours->count;
}

int config_hours_next(const struct config_hours *hours, int minute)
{
	const bool is_on = config_hours_are_on(hours, minute);

	for (int i = 1; i < HOURS_WEEK; i++)
		if (config_hours_are_on(hours, (minute + i) % HOURS_WEEK) != is_on)
			return (minute + i) % HOURS_WEEK;
	return -1;
}

int config_hours_minute(time_t wall)
{
	struct tm local = {.tm_min = 0};

	tzset();
	localtime_r(&wall, &local);
	return local.tm_wday * HOURS_DAY + local.tm_hour * 60 + local.tm_min;
}

void config_hours_moment(int minute, char text[HOURS_MOMENT_MAX])
{
	const unsigned m = (unsigned)minute % HOURS_WEEK;

	snprintf(text, HOURS_MOMENT_MAX, "%.3s %02u:%02u", day_names[m / HOURS_DAY],
		 m % HOURS_DAY / 60, m % 60);
}
