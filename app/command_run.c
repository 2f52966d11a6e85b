/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

#include "app/kiosk/kiosk.h"
#include "app/settings.h"
#include "hal/base/log.h"

struct run_options {
	struct settings settings;
	int frames;
	const char *stats;
};

#define AT(field) .place = offsetof(struct run_options, field)

static const struct option_row rows[] = {SETTINGS_ROWS,
					 {"frames", OPTION_INT, AT(frames), .min = 1,
					  .max = 1000000000, .argument = "N",
					  .help = "end after N pictures have been shown"},
					 {"stats", OPTION_TEXT, AT(stats), .argument = "FILE.jsonl",
					  .help = "write a line of statistics a second"},
					 {"print-config", OPTION_FLAG, AT(settings.print),
					  .help = "print the whole configuration and end"},
					 {.name = NULL}};

/* Reads the configuration as at the start, but faults do not end the kiosk. */
static int reread(void *context, struct config **fresh, struct ini_report *report)
{
	const struct run_options *options = context;
	int err;

	*fresh = NULL;
	report->say = settings_say;
	err = settings_read(&options->settings, fresh, report);
	if (!err)
		err = config_check(*fresh, report);
	if (!err)
		return 0;
	config_destroy(*fresh);
	*fresh = NULL;
	return err;
}

static int run_config(struct run_options *options, struct config *config, struct ini_report *report)
{
	struct kiosk_settings settings = {
		.config = config,
		.frames = (uint64_t)options->frames,
		.stats = options->stats,
		.reread = reread,
		.context = options,
	};
	int err = config_check(config, report);

	return err ? err : kiosk_run(&settings, &report->first);
}

static int run_run(const struct command *command, int argc, char **argv)
{
	struct run_options options = {.frames = 0};
	struct ini_report report = {.count = 0};
	struct config *config = NULL;
	int code = command_read_all(command, argc, argv, rows, &options), err;

	if (code != COMMAND_GOES_ON)
		return code;
	err = settings_read(&options.settings, &config, &report);
	if (!err && options.settings.print)
		config_print(config, stdout);
	else if (!err)
		err = run_config(&options, config, &report);
	if (err)
		log_error("%s", report.first.text);
	config_destroy(config);
	return err ? EXIT_FAILURE : EXIT_SUCCESS;
}

const struct command command_run = {
	.name = "run",
	.usage = "[--config FILE] [--set SECTION.KEY=VALUE]... [--frames N] [--stats FILE.jsonl]",
	.summary = "cameras to screen, until a signal, a button or --frames ends it",
	.help = "\nSIGINT and SIGTERM end it in order; SIGHUP has the configuration read again, and the file of --stats\n"
		"opened again. A camera, a screen or buttons that are absent are waited for; what is not a camera, or a\n"
		"screen that another program holds at the start, ends it with exit code 1.\n",
	.run = run_run,
};
