/* SPDX-License-Identifier: MIT */
#include "hal/ini/ini_names.h"

#include <ctype.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>

#define NEAREST_LENGTH_MAX 64 /* longer names have no nearest one */

static unsigned smallest_of_three(unsigned a, unsigned b, unsigned c)
{
	unsigned m = a < b ? a : b;

	return m < c ? m : c;
}

/* Optimal string alignment distance: inserts, deletes, replaces, or swaps two neighbours. Ignores
 * case. */
static unsigned edit_distance(const char *a, const char *b)
{
	unsigned rows[3][NEAREST_LENGTH_MAX + 1];
	size_t a_length = strlen(a), b_length = strlen(b);

	if (a_length > NEAREST_LENGTH_MAX || b_length > NEAREST_LENGTH_MAX)
		return UINT_MAX;
	for (unsigned j = 0; j <= b_length; j++)
		rows[0][j] = j;
	for (unsigned i = 1; i <= a_length; i++) {
		unsigned *row = rows[i % 3], *last = rows[(i + 2) % 3];
		const unsigned *second_last = rows[(i + 1) % 3];

		row[0] = i;
		for (unsigned j = 1; j <= b_length; j++) {
			int x = tolower((unsigned char)a[i - 1]),
			    y = tolower((unsigned char)b[j - 1]);

			row[j] = smallest_of_three(last[j] + 1, row[j - 1] + 1,
						   last[j - 1] + (x != y));
			if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] &&
			    second_last[j - 2] + 1 < row[j])
				row[j] = second_last[j - 2] + 1;
		}
	}
	return rows[a_length % 3][b_length];
}

const char *ini_nearest(const char *name, const char *const *candidates, size_t count)
{
	/* A name of which more than a third or all letters are wrong is another word. */
	size_t length = strlen(name);
	unsigned best = (unsigned)(length < 3 ? 1 : length < 6 ? 2 : length / 3) + 1;
	const char *nearest = NULL;

	for (size_t i = 0; i < count; i++) {
		unsigned distance = edit_distance(name, candidates[i]);

		if (distance < best && distance < strlen(candidates[i])) {
			best = distance;
			nearest = candidates[i];
		}
	}
	return nearest;
}

const char *ini_prefix(const struct ini_table *table)
{
	return table->prefix ? table->prefix : "";
}

const struct ini_table *ini_table_of(const struct ini_table *tables, const char *section)
{
	for (const struct ini_table *t = tables; t->section; t++) {
		if (!strcmp(t->section, section))
			return t;
	}
	return NULL;
}

const struct ini_key *ini_key_of(const struct ini_table *tables, const char *section,
				 const char *name, const struct ini_table **owner)
{
	for (const struct ini_table *t = tables; t->section; t++) {
		size_t prefix = strlen(ini_prefix(t));

		if (strcmp(t->section, section) != 0 || strncmp(name, ini_prefix(t), prefix) != 0)
			continue;
		for (const struct ini_key *key = t->keys; key->name; key++) {
			if (!strcmp(key->name, name + prefix)) {
				*owner = t;
				return key;
			}
		}
	}
	return NULL;
}

/* Replaces best by candidate if that is nearer to name. */
static void keep_nearer(const char *name, char best[INI_NAME_MAX], const char *candidate)
{
	const char *pair[2] = {best, candidate};

	if (ini_nearest(name, pair, 2) == candidate)
		snprintf(best, INI_NAME_MAX, "%s", candidate);
}

void ini_nearest_section(const struct ini_table *tables, const char *name, char best[INI_NAME_MAX])
{
	best[0] = '\0';
	for (const struct ini_table *t = tables; t->section; t++)
		keep_nearer(name, best, t->section);
}

void ini_nearest_key(const struct ini_table *tables, const char *section, const char *name,
		     char best[INI_NAME_MAX])
{
	best[0] = '\0';
	for (const struct ini_table *t = tables; t->section; t++) {
		if (strcmp(t->section, section) != 0)
			continue;
		for (const struct ini_key *key = t->keys; key->name; key++) {
			char full[INI_NAME_MAX];

			snprintf(full, sizeof(full), "%s%s", ini_prefix(t), key->name);
			keep_nearer(name, best, full);
		}
	}
}
