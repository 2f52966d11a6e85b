/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

#include "app/pipeline/pipeline_config.h"
#include "app/settings.h"
#include "config/config_hours.h"
#include "hal/base/log.h"
#include "hal/basis/basis.h"

struct check_options {
	struct settings settings;
	bool sample;
};

#define AT(field) .place = offsetof(struct check_options, field)

static const struct option_row rows[] = {
	SETTINGS_ROWS,
	{"print-config", OPTION_FLAG, AT(settings.print),
	 .help = "print the whole configuration instead"},
	{"sample", OPTION_FLAG, AT(sample),
	 .help = "print every key at its default, with range and meaning, instead"},
	{.name = NULL}};

/* Opens the basis. NULL: it cannot be opened, or the configuration names none, which config_check()
 * has logged. */
static const struct basis *open_checked_basis(struct basis *basis, const struct config *config,
					      int *err)
{
	struct fault fault = {.text = ""};

	if (!*config->basis.file)
		return NULL;
	*err = pipeline_open_basis(basis, config->basis.file, pipeline_part_of(config), &fault);
	if (*err)
		log_error("%s: [basis] file: %s", config->name, fault.text);
	else
		pipeline_warn_of_lamps(basis, &config->lamps);
	return *err ? NULL : basis;
}

static int check_config(const struct config *config, struct ini_report *report)
{
	struct basis basis = {.map = NULL};
	uint8_t *mask = NULL;
	int err = config_check(config, report), basis_err = 0, more_err;

	more_err = pipeline_config_check(config, open_checked_basis(&basis, config, &basis_err),
					 &mask);
	free(mask);
	basis_close(&basis);
	return err ? err : basis_err ? basis_err : more_err;
}

/* A zone may be a sound one and still not that of the place. */
static void say_local_time(const struct config *config)
{
	char here[HOURS_MOMENT_MAX];

	if (!*config->screen->hours)
		return;
	if (*config->screen->time_zone)
		setenv("TZ", config->screen->time_zone, 1);
	config_hours_moment(config_hours_minute(time(NULL)), here);
	printf("[screen] hours: it is %s here\n", here);
}

static int print_sample(void)
{
	struct config *config;
	int err = config_create(&config, driver_list());

	if (err)
		return EXIT_FAILURE;
	config_write_sample(config, stdout);
	config_destroy(config);
	return EXIT_SUCCESS;
}

static int check_run(const struct command *command, int argc, char **argv)
{
	struct check_options options = {.sample = false};
	struct ini_report report = {.say = settings_say};
	struct config *config = NULL;
	int code = command_read_all(command, argc, argv, rows, &options), err, check_err;

	if (code != COMMAND_GOES_ON)
		return code;
	if (options.sample)
		return print_sample();
	err = settings_read(&options.settings, &config, &report);
	/* A file that cannot be read has no other faults. */
	if (options.settings.print && !err)
		config_print(config, stdout);
	else if (config && (!err || err == -EINVAL)) {
		check_err = check_config(config, &report);
		if (!err)
			err = check_err;
		if (!err) {
			puts("configuration is fine");
			say_local_time(config);
		}
	}
	config_destroy(config);
	return err ? EXIT_FAILURE : EXIT_SUCCESS;
}

const struct command command_check = {
	.name = "check",
	.usage = "[--config FILE] [--set SECTION.KEY=VALUE]...",
	.summary = "say all that is wrong with a configuration; opens no device",
	.run = check_run,
};
