/* SPDX-License-Identifier: MIT */
#include "tests/vm/tools/driver_option.h"

#include <stdio.h>

static void *driver_option_place(void *root, const char *instance)
{
	(void)instance;
	return root;
}

int driver_option_set(const char *driver, const struct ini_key *keys, void *options,
		      const char *option)
{
	static const struct ini_key none[] = {INI_KEYS_END};
	const struct ini_table tables[] = {
		{.section = driver, .keys = keys ? keys : none, .place = driver_option_place},
		INI_TABLES_END};
	struct ini_report report = {0};
	char assignment[INI_PATH_MAX + INI_TEXT_MAX];

	snprintf(assignment, sizeof(assignment), "%s.%s", driver, option);
	const int err = ini_set(assignment, tables, options, &report);
	if (err)
		fprintf(stderr, "%s\n", report.first.text);
	return err;
}
