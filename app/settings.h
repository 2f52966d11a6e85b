/* SPDX-License-Identifier: MIT */
/* What the commands of `inlay` share: the configuration, the drivers, the list of commands. */
#ifndef INLAY_APP_SETTINGS_H
#define INLAY_APP_SETTINGS_H

#include <stdbool.h>

#include "config/config.h"
#include "hal/options/options.h"

/* The options --config and --set of run, still and check. */

#define SETTINGS_FILE "/etc/inlay/kiosk.conf" /* of the installed service (board/appliance.conf) */

struct settings {
	const char *config_file; /* NULL: SETTINGS_FILE, or defaults where there is none */
	struct option_list set;
	bool print; /* --print-config */
};

/* Rows of a command whose AT(settings) is a struct settings. */
/* clang-format off */
#define CONFIG_ROW(text)									   \
	{"config", OPTION_TEXT, AT(settings.config_file), .argument = "FILE", .help = (text)}
#define SETTINGS_ROWS										   \
	CONFIG_ROW("read this configuration, else " SETTINGS_FILE ", where there is one"),	   \
	{"set", OPTION_LIST, AT(settings.set),						   \
	 .argument = "SECTION.KEY=VALUE", .help = "change one key; may be given again"}
/* clang-format on */

/* The file to read: --config, else SETTINGS_FILE where there is one; NULL: there is none. */
const char *settings_file(const struct settings *settings);

/* Logs a fault: struct ini_report, say. */
void settings_say(void *context, const char *text);

/* Reads the configuration that they give. Every fault goes to the report; 0 or the first error.
 * *config is made unless memory is short, so that a check can go on. */
int settings_read(const struct settings *settings, struct config **config,
		  struct ini_report *report);

/* Names of the drivers and their tables of keys, in the order of the arrays in drivers/drivers.h,
 * so that an index serves both. Lives as long as the program. */
const struct config_drivers *driver_list(void);

/* The commands of `inlay`, in the order of --help. */

extern const struct command command_run, command_control, command_still, command_grab,
	command_devices, command_check;

#endif
