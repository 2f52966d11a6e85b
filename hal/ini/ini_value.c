/* SPDX-License-Identifier: MIT */
#include "hal/ini/ini_value.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/number.h"
#include "hal/base/plain_text.h"

#define ECHO_MAX 60 /* bytes of a wrong value that a fault quotes */

/* Text that grows by pieces and is cut at room; length counts the whole text, as snprintf()
 * does. */
struct words {
	char *text;
	size_t room, length;
};

__attribute__((format(printf, 2, 3))) static void words_add(struct words *words, const char *format,
							    ...)
{
	size_t at = words->length < words->room ? words->length : words->room;
	va_list args;
	int n;

	va_start(args, format);
	n = vsnprintf(words->text + at, words->room - at, format, args);
	va_end(args);
	if (n > 0)
		words->length += (size_t)n;
}

static bool key_bounded(const struct ini_key *key)
{
	return key->min != 0 || key->max != 0;
}

static void words_add_range(struct words *words, const struct ini_key *key)
{
	if (key_bounded(key)) {
		if (fabs(key->min) < 1e15 && fabs(key->max) < 1e15)
			words_add(words, " %.10g..%.10g", key->min, key->max);
		else if (fabs(key->min) < 1e15)
			words_add(words, " of at least %.10g", key->min);
		else if (fabs(key->max) < 1e15)
			words_add(words, " of at most %.10g", key->max);
	}
	if (key->unit)
		words_add(words, " %s", key->unit);
}

void ini_value_expected(const struct ini_key *key, char *text, size_t room)
{
	struct words words = {text, room, 0};

	switch (key->type) {
	case INI_BOOL:
		words_add(&words, "yes or no");
		break;
	case INI_INT:
		words_add(&words, "a whole number");
		words_add_range(&words, key);
		break;
	case INI_REAL:
		words_add(&words, "a number");
		words_add_range(&words, key);
		break;
	case INI_LEVEL:
		words_add(&words, "a number");
		words_add_range(&words, key);
		words_add(&words, " or a percentage 0%%..100%%");
		break;
	case INI_REALS:
		words_add(&words, "%u numbers", key->count);
		words_add_range(&words, key);
		break;
	case INI_LIST:
		words_add(&words, "at most %u numbers", key->count);
		words_add_range(&words, key);
		break;
	case INI_TEXT:
		words_add(&words, "text of at most %d bytes", INI_TEXT_MAX - 1);
		break;
	case INI_PATH:
		words_add(&words, "a path of at most %d bytes", INI_PATH_MAX - 1);
		break;
	case INI_CHOICE:
		words_add(&words, "one of ");
		for (int i = 0; key->choices[i]; i++)
			words_add(&words, "%s%s", i ? ", " : "", key->choices[i]);
		break;
	}
}

static int value_refuse(const struct ini_key *key, const char *text, char why[INI_WHY_MAX])
{
	struct words words = {why, INI_WHY_MAX, 0};
	char expected[INI_WHY_MAX];

	ini_value_expected(key, expected, sizeof(expected));
	if (*text)
		words_add(&words, "is \"%.*s%s\", expected %s", ECHO_MAX, text,
			  strlen(text) > ECHO_MAX ? "..." : "", expected);
	else
		words_add(&words, "has no value, expected %s", expected);
	return -EINVAL;
}

bool ini_truth_read(const char *text, bool *value)
{
	static const char *const yes[] = {"yes", "true", "on", "1"};
	static const char *const no[] = {"no", "false", "off", "0"};

	for (size_t i = 0; i < sizeof(yes) / sizeof(*yes); i++) {
		if (!strcasecmp(text, yes[i]) || !strcasecmp(text, no[i])) {
			*value = !strcasecmp(text, yes[i]);
			return true;
		}
	}
	return false;
}

static bool key_within(const struct ini_key *key, double value)
{
	return isfinite(value) && (!key_bounded(key) || (value >= key->min && value <= key->max));
}

static int value_read_int(const struct ini_key *key, const char *text, int *value)
{
	char *end;
	long n;

	errno = 0;
	n = strtol(text, &end, 10);
	if (end == text || *end || errno || n < INT_MIN || n > INT_MAX ||
	    !key_within(key, (double)n))
		return -EINVAL;
	*value = (int)n;
	return 0;
}

/* Reads one number at *text and moves *text past it. */
static int value_read_number(const struct ini_key *key, const char **text, double *value)
{
	const char *at = *text;
	double v;

	if (number_read(&at, &v) || !key_within(key, v))
		return -EINVAL;
	*value = v;
	*text = at;
	return 0;
}

static int value_read_real(const struct ini_key *key, const char *text, double *value)
{
	double v;
	int err = value_read_number(key, &text, &v);

	if (err || *text)
		return -EINVAL;
	*value = v;
	return 0;
}

int ini_level_read(const char *text, double max, struct ini_level *level)
{
	const struct ini_key number = {.min = 0, .max = max}, percentage = {.min = 0, .max = 100};
	const size_t length = strlen(text);
	const bool percent = length > 1 && text[length - 1] == '%';
	double value;

	if (value_read_number(percent ? &percentage : &number, &text, &value) ||
	    strlen(text) != percent)
		return -EINVAL;
	*level = (struct ini_level){value, percent};
	return 0;
}

static const char *skip_blank(const char *text)
{
	return text + strspn(text, " \t");
}

/* Reads exactly count numbers. The first pass only checks, so that a wrong list leaves the field
 * unchanged. */
static int value_read_numbers(const struct ini_key *key, unsigned count, const char *text,
			      double *values)
{
	for (int pass = 0; pass < 2; pass++) {
		const char *at = skip_blank(text);

		for (unsigned i = 0; i < count; i++) {
			double v;
			const char *before;
			int err = value_read_number(key, &at, &v);

			if (err)
				return err;
			if (pass)
				values[i] = v;
			before = at;
			at = skip_blank(at);
			if (i + 1 < count && *at == ',')
				at = skip_blank(at + 1);
			if (i + 1 < count && at == before)
				return -EINVAL;
		}
		if (*at)
			return -EINVAL;
	}
	return 0;
}

static int value_read_list(const struct ini_key *key, const char *text, double *values)
{
	for (unsigned count = 0; count <= key->count; count++) {
		if (count ? value_read_numbers(key, count, text, values) : *skip_blank(text) != 0)
			continue;
		for (unsigned i = count; i < key->count; i++)
			values[i] = 0;
		return 0;
	}
	return -EINVAL;
}

static int value_read_text(const char *text, size_t room, char *value)
{
	size_t length = strlen(text);

	if (length >= room)
		return -EINVAL;
	memcpy(value, text, length + 1);
	return 0;
}

static int value_read_path(const char *text, const char *folder, char *value)
{
	size_t text_length = strlen(text);
	size_t folder_length = folder ? strlen(folder) : 0;

	if (!*text || *text == '/' || !folder_length)
		return value_read_text(text, INI_PATH_MAX, value);
	if (folder_length + 1 + text_length >= INI_PATH_MAX)
		return -EINVAL;
	stpcpy(stpcpy(stpcpy(value, folder), "/"), text);
	return 0;
}

static int value_read_choice(const struct ini_key *key, const char *text, int *value)
{
	for (int i = 0; key->choices[i]; i++) {
		if (!strcmp(text, key->choices[i])) {
			*value = i;
			return 0;
		}
	}
	return -EINVAL;
}

static void offer_choice(const struct ini_key *key, const char *text, char why[INI_WHY_MAX])
{
	size_t count = 0, length = strlen(why);
	const char *near;

	while (key->choices[count])
		count++;
	near = ini_nearest(text, key->choices, count);
	if (near)
		snprintf(why + length, INI_WHY_MAX - length, "; did you mean \"%s\"?", near);
}

int ini_value_read(const struct ini_key *key, const char *text, const char *folder, void *values,
		   char why[INI_WHY_MAX])
{
	const bool free = key->type == INI_TEXT || key->type == INI_PATH;
	const char *odd = text_oddity(text, !free);
	void *field = (char *)values + key->offset;
	struct fault trouble = {.text = ""};
	int err = -EINVAL;

	if (odd) {
		snprintf(why, INI_WHY_MAX, "%s", odd);
		return -EINVAL;
	}
	if (key->check && key->check(text, &trouble)) {
		snprintf(why, INI_WHY_MAX, "%.*s", INI_WHY_MAX - 1, trouble.text);
		return -EINVAL;
	}
	switch (key->type) {
	case INI_BOOL:
		err = ini_truth_read(text, field) ? 0 : -EINVAL;
		break;
	case INI_INT:
		err = value_read_int(key, text, field);
		break;
	case INI_REAL:
		err = value_read_real(key, text, field);
		break;
	case INI_LEVEL:
		err = ini_level_read(text, key->max, field);
		break;
	case INI_REALS:
		err = value_read_numbers(key, key->count, text, field);
		break;
	case INI_LIST:
		err = value_read_list(key, text, field);
		break;
	case INI_TEXT:
		err = value_read_text(text, INI_TEXT_MAX, field);
		break;
	case INI_PATH:
		err = value_read_path(text, folder, field);
		break;
	case INI_CHOICE:
		err = value_read_choice(key, text, field);
		break;
	}
	if (err) {
		value_refuse(key, text, why);
		if (key->type == INI_CHOICE)
			offer_choice(key, text, why);
	}
	return err;
}

/* Adds the shortest decimal that reads back as the same double. */
static void words_add_real(struct words *words, double value)
{
	char text[40];

	for (int digits = 6; digits <= 17; digits++) {
		snprintf(text, sizeof(text), "%.*g", digits, value);
		if (strtod(text, NULL) == value)
			break;
	}
	words_add(words, "%s", text);
}

void ini_level_text(const struct ini_level *level, char text[INI_LEVEL_TEXT_MAX])
{
	struct words words = {text, INI_LEVEL_TEXT_MAX, 0};

	words_add_real(&words, level->value);
	if (level->percent)
		words_add(&words, "%%");
}

int ini_value_text(const struct ini_key *key, const void *values, char *text, size_t room)
{
	const void *field = (const char *)values + key->offset;
	struct words words = {text, room, 0};

	words_add(&words, "%s", ""); /* a list may be empty */
	switch (key->type) {
	case INI_BOOL:
		words_add(&words, "%s", *(const bool *)field ? "yes" : "no");
		break;
	case INI_INT:
		words_add(&words, "%d", *(const int *)field);
		break;
	case INI_REAL:
		words_add_real(&words, *(const double *)field);
		break;
	case INI_LEVEL: {
		char level[INI_LEVEL_TEXT_MAX];

		ini_level_text(field, level);
		words_add(&words, "%s", level);
		break;
	}
	case INI_REALS:
	case INI_LIST:
		for (unsigned i = 0; i < key->count; i++) {
			if (key->type == INI_LIST && ((const double *)field)[i] == 0)
				break;
			words_add(&words, "%s", i ? " " : "");
			words_add_real(&words, ((const double *)field)[i]);
		}
		break;
	case INI_TEXT:
	case INI_PATH:
		words_add(&words, "%s", (const char *)field);
		break;
	case INI_CHOICE:
		words_add(&words, "%s", key->choices[*(const int *)field]);
		break;
	}
	return (int)words.length;
}

bool ini_left_out(const struct ini_key *key, const void *values)
{
	char text[512];

	if (!key->rare || !key->fallback)
		return false;
	ini_value_text(key, values, text, sizeof(text));
	return !strcmp(text, key->fallback);
}

void ini_defaults(const struct ini_key *keys, void *values)
{
	char why[INI_WHY_MAX];

	for (const struct ini_key *key = keys; key->name; key++) {
		if (key->fallback && ini_value_read(key, key->fallback, NULL, values, why)) {
			/* The table contradicts itself: an error of the program, not of a file. */
			fprintf(stderr, "default of key \"%s\" %s\n", key->name, why);
			abort();
		}
	}
}
