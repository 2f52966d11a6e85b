/* SPDX-License-Identifier: MIT */
/* The options --config and --set of run, still and check. */
#ifndef INLAY_APP_SETTINGS_H
#define INLAY_APP_SETTINGS_H

#include <stdbool.h>

#include "app/options.h"
#include "config/config.h"

#define SETTINGS_SETS_MAX 64
#define SETTINGS_FILE "/etc/inlay/kiosk.conf" /* of the installed service (board/appliance.conf) */

struct settings {
	const char *config_file; /* NULL: SETTINGS_FILE, or defaults where there is none */
	const char *sets[SETTINGS_SETS_MAX];
	int set_count;
	bool print; /* --print-config */
};

/* Rows for an option table whose context begins with a struct settings. */
#define SETTINGS_ROWS                                                                              \
	{.name = "config",                                                                         \
	 .argument = "FILE",                                                                       \
	 .help = "read this configuration, else " SETTINGS_FILE ", where there is one",            \
	 .take = settings_take_config},                                                            \
	{                                                                                          \
		.name = "set", .argument = "SECTION.KEY=VALUE",                                    \
		.help = "change one key; may be given again", .take = settings_take_set            \
	}

/* The file to read: --config, else SETTINGS_FILE where there is one; NULL: there is none. */
const char *settings_file(const struct settings *settings);

int settings_take_config(void *context, const char *argument, const char **expected);
int settings_take_set(void *context, const char *argument, const char **expected);
int settings_take_print(void *context, const char *argument, const char **expected);

/* Logs a fault: struct ini_report, say. */
void settings_say(void *context, const char *text);

/* Reads the configuration that they give. Every fault goes to the report; 0 or the first error.
 * *config is made unless memory is short, so that a check can go on. */
int settings_read(const struct settings *settings, struct config **config,
		  struct ini_report *report);

#endif
