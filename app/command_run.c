/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <stdio.h>

#include "app/commands.h"
#include "app/kiosk/kiosk.h"
#include "app/settings.h"
#include "hal/base/log.h"

struct run_options {
	struct settings settings; /* has to be first: SETTINGS_ROWS */
	long frames;
	const char *stats;
};

static int take_frames(void *context, const char *argument, const char **expected)
{
	*expected = "a whole number of at least 1";
	return option_integer(argument, 1, 1000000000, &((struct run_options *)context)->frames);
}

static int take_stats(void *context, const char *argument, const char **expected)
{
	(void)expected;
	((struct run_options *)context)->stats = argument;
	return 0;
}

static const struct option_row rows[] = {SETTINGS_ROWS,
					 {.name = "frames",
					  .argument = "N",
					  .help = "end after N pictures have been shown",
					  .take = take_frames},
					 {.name = "stats",
					  .argument = "FILE.jsonl",
					  .help = "write a line of statistics a second",
					  .take = take_stats},
					 {.name = "print-config",
					  .help = "print the whole configuration and end",
					  .take = settings_take_print},
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

static int run_command(int argc, char **argv)
{
	struct run_options options = {.frames = 0};
	struct ini_report report = {.count = 0};
	struct config *config = NULL;
	int code = options_read(&command_run, argc, argv, &options), err;

	if (code != OPTIONS_GO_ON)
		return code;
	err = settings_read(&options.settings, &config, &report);
	if (!err && options.settings.print)
		config_print(config, stdout);
	else if (!err)
		err = run_config(&options, config, &report);
	if (err)
		log_error("%s", report.first.text);
	config_destroy(config);
	return err ? EXIT_FAILED : EXIT_DONE;
}

const struct command command_run = {
	.name = "run",
	.usage = "[--config FILE] [--set SECTION.KEY=VALUE]... [--frames N] [--stats FILE.jsonl]",
	.purpose = "cameras to screen, until a signal, a button or --frames ends it",
	.details =
		"SIGINT and SIGTERM end it in order; SIGHUP has the configuration read again, and the file of --stats\n"
		"opened again. A camera, a screen or buttons that are absent are waited for; what is not a camera, or a\n"
		"screen that another program holds at the start, ends it with exit code 1.",
	.options = rows,
	.run = run_command,
};
