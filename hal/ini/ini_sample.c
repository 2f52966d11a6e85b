/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "hal/ini/ini_value.h"

#define WRAP_COLUMN 90

/* Writes text as comment lines, "; " before each, broken at blanks. */
static void sample_write_comment(FILE *stream, const char *text)
{
	while (*text) {
		size_t length = strlen(text);

		if (length > WRAP_COLUMN) {
			length = WRAP_COLUMN;
			while (length && text[length] != ' ')
				length--;
			if (!length)
				length = strcspn(text, " ");
		}
		fprintf(stream, "; %.*s\n", (int)length, text);
		text += length;
		text += strspn(text, " ");
	}
}

/* Writes help and range of a key; leaves out the maximal length of texts and paths. */
static void sample_write_help(FILE *stream, const struct ini_key *key)
{
	const char *help = key->help ? key->help : key->name;
	size_t length = strlen(help);
	char expected[INI_WHY_MAX], comment[2 * INI_WHY_MAX];

	if (length && help[length - 1] == '.')
		length--;
	ini_value_expected(key, expected, sizeof(expected));
	if (key->type == INI_TEXT || key->type == INI_PATH)
		snprintf(comment, sizeof(comment), "%.*s.", (int)length, help);
	else
		snprintf(comment, sizeof(comment), "%.*s (%s).", (int)length, help, expected);
	sample_write_comment(stream, comment);
}

static void sample_write_key(FILE *stream, const char *prefix, const struct ini_key *key)
{
	fputc('\n', stream);
	sample_write_help(stream, key);
	if (key->fallback)
		fprintf(stream, "%s%s =%s%s\n", prefix, key->name, *key->fallback ? " " : "",
			key->fallback);
	else
		fprintf(stream, "; must be given:\n; %s%s =\n", prefix, key->name);
}

static bool section_came_before(const struct ini_table *tables, const struct ini_table *table)
{
	for (const struct ini_table *t = tables; t < table; t++) {
		if (!strcmp(t->section, table->section))
			return true;
	}
	return false;
}

static void sample_write_other_names(FILE *stream, const struct ini_table *table, const char *names)
{
	if (!table->named)
		return;
	while (names += strspn(names, " "), *names) {
		size_t length = strcspn(names, " ");

		fprintf(stream, "\n; The same keys.\n[%s %.*s]\n", table->section, (int)length,
			names);
		names += length;
	}
}

void ini_write_sample(FILE *stream, const struct ini_table *tables)
{
	for (const struct ini_table *table = tables; table->section; table++) {
		const char *name;
		size_t length;

		if (section_came_before(tables, table))
			continue;
		if (table != tables)
			fputc('\n', stream);
		if (table->help)
			sample_write_comment(stream, table->help);
		name = table->sample && *table->sample ? table->sample : "NAME";
		length = table->named ? strcspn(name, " ") : 0;
		fprintf(stream, "%s[%s%s%.*s]\n", table->sample && !*table->sample ? "; " : "",
			table->section, length ? " " : "", (int)length, name);
		for (const struct ini_table *t = table; t->section; t++) {
			if (strcmp(t->section, table->section) != 0)
				continue;
			for (const struct ini_key *key = t->keys; key->name; key++)
				sample_write_key(stream, t->prefix ? t->prefix : "", key);
		}
		sample_write_other_names(stream, table, name + length);
	}
}
