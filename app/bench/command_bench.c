/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "app/bench/bench.h"
#include "app/bench/bench_print.h"
#include "app/commands.h"
#include "hal/base/log.h"
#include "hal/base/output.h"
#include "hal/base/pool.h"
#include "hal/colour/transfer.h"
#include "hal/compositor/kernels/kernels.h"
#include "hal/ini/ini.h"

struct bench_options {
	struct bench_settings settings;
	const char *csv;
	bool json;
};

static int take_basis(void *context, const char *argument, const char **expected)
{
	(void)expected;
	((struct bench_options *)context)->settings.basis = argument;
	return 0;
}

static int take_csv(void *context, const char *argument, const char **expected)
{
	(void)expected;
	((struct bench_options *)context)->csv = argument;
	return 0;
}

static int take_json(void *context, const char *argument, const char **expected)
{
	(void)argument;
	(void)expected;
	((struct bench_options *)context)->json = true;
	return 0;
}

static int take_kernel(void *context, const char *argument, const char **expected)
{
	*expected = "auto, or the name of a kernel that this processor supports";
	if (!kernels_choose(argument))
		return -EINVAL;
	((struct bench_options *)context)->settings.kernel = argument;
	return 0;
}

static int take_file(const char **files, int *count, const char *argument, const char **expected)
{
	*expected = "no more than 16 of them";
	if (*count == BENCH_FILES_MAX)
		return -EINVAL;
	files[(*count)++] = argument;
	return 0;
}

static int take_lights(void *context, const char *argument, const char **expected)
{
	struct bench_settings *s = &((struct bench_options *)context)->settings;

	return take_file(s->lights, &s->light_files, argument, expected);
}

static int take_panorama(void *context, const char *argument, const char **expected)
{
	struct bench_settings *s = &((struct bench_options *)context)->settings;

	return take_file(s->panoramas, &s->panorama_files, argument, expected);
}

static int take_count(const char *argument, long low, long high, int *count)
{
	long value;
	const int err = option_integer(argument, low, high, &value);

	if (!err)
		*count = (int)value;
	return err;
}

static int take_threads(void *context, const char *argument, const char **expected)
{
	*expected = "a whole number 1..1024, or 0 for one a processor";
	return take_count(argument, 0, POOL_THREADS_MAX,
			  &((struct bench_options *)context)->settings.threads);
}

static int take_repeat(void *context, const char *argument, const char **expected)
{
	*expected = "a whole number 1..100000";
	return take_count(argument, 1, 100000, &((struct bench_options *)context)->settings.repeat);
}

static int take_cells(void *context, const char *argument, const char **expected)
{
	*expected = "a whole number 0..32768";
	return take_count(argument, 0, BASIS_LIGHTS_MAX,
			  &((struct bench_options *)context)->settings.cells);
}

static int take_threshold(void *context, const char *argument, const char **expected)
{
	struct bench_settings *settings = &((struct bench_options *)context)->settings;
	struct ini_level level;
	const int err = ini_level_read(argument, 255, &level);

	*expected = "a grey level 0..255 or a percentage 0%..100%";
	if (err)
		return err;
	settings->threshold = level.percent ? 0 : transfer_decode(TRANSFER_SRGB, level.value / 255);
	settings->budget = level.percent ? level.value / 100 : 0;
	return 0;
}

static int take_thesis(void *context, const char *argument, const char **expected)
{
	*expected = "yes or no";
	if (strcmp(argument, "yes") != 0 && strcmp(argument, "no") != 0)
		return -EINVAL;
	((struct bench_options *)context)->settings.thesis = !strcmp(argument, "yes");
	return 0;
}

static const struct option_row rows[] = {
	{.name = "basis", .argument = "FILE", .help = "the basis file", .take = take_basis},
	{.name = "kernel",
	 .argument = "NAME",
	 .help = "one kernel, or auto for the fastest; else each that the processor supports",
	 .take = take_kernel},
	{.name = "lights",
	 .argument = "FILE",
	 .help = "a lighting: a line of \"r g b\" for each light, in dome order; may be given again",
	 .take = take_lights},
	{.name = "panorama",
	 .argument = "FILE",
	 .help = "a lighting: an equirectangular picture in linear light; may be given again",
	 .take = take_panorama},
	{.name = "cells",
	 .argument = "N",
	 .help = "how many of the cells are lit alone where no lighting is given; 32",
	 .take = take_cells},
	{.name = "threshold",
	 .argument = "LEVEL",
	 .help = "leave out lights below this grey level, 0..255, or what changes no pixel by more of white: 1%; 0 takes all",
	 .take = take_threshold},
	{.name = "threads",
	 .argument = "N",
	 .help = "threads that make a picture, 0 for one a processor; 1",
	 .take = take_threads},
	{.name = "repeat",
	 .argument = "N",
	 .help = "how often each way is timed; 15",
	 .take = take_repeat},
	{.name = "thesis",
	 .argument = "YES|NO",
	 .help = "whether to run the thesis's algorithm too, which takes much memory; yes",
	 .take = take_thesis},
	{.name = "json", .help = "every figure, for programs", .take = take_json},
	{.name = "csv",
	 .argument = "FILE",
	 .help = "write every figure of the table there too",
	 .take = take_csv},
	{.name = NULL}};

/* Opens the CSV file first, so that a folder that does not exist is reported before minutes of
 * work. */
static int run_bench(const struct bench_options *options, struct fault *fault)
{
	struct bench_report report = {.width = 0};
	struct output csv = {.stream = NULL};
	int err = options->csv ? output_open(&csv, options->csv, fault) : 0;

	if (!err)
		err = bench_run(&options->settings, &report, fault);
	if (!err && options->csv) {
		table_write_csv(&report.rows, csv.stream);
		err = output_commit(&csv, fault);
	}
	if (!err && options->json)
		bench_print_json(&report, stdout);
	else if (!err)
		bench_print_text(&report, stdout);
	table_free(&report.rows);
	output_abandon(&csv);
	return err;
}

static int bench_command(int argc, char **argv)
{
	struct bench_options options = {
		.settings = {.threads = 1, .repeat = 15, .cells = 32, .thesis = true}};
	struct fault fault = {.text = ""};
	int code = options_read(&command_bench, argc, argv, &options), err;

	if (code != OPTIONS_GO_ON)
		return code;
	if (!options.settings.basis) {
		log_error("bench: --basis FILE is missing");
		return EXIT_USAGE;
	}
	err = run_bench(&options, &fault);
	if (err)
		log_error("%s", fault.text);
	return err ? EXIT_FAILED : EXIT_DONE;
}

const struct command command_bench = {
	.name = "bench",
	.usage = "--basis FILE [--lights FILE]... [--panorama FILE]... [options]",
	.purpose = "what a picture of a basis takes, and how exact it is, beside the thesis's way",
	.details =
		"One row each, timed in turns on the same pixels under the same lights: the thesis's algorithm in\n"
		"double precision; the exact layer; the fast one; a whole frame from two YUYV cameras of the\n"
		"basis's size; copying the picture. Errors are the worst of all that the lighting holds.\n"
		"    x thesis  the thesis's median time over this one\n"
		"    x copy    the least time over that of copying the picture\n"
		"    PSNR, RMS, max   against double precision, not rounded: 8 bits alone are 58.9 dB\n"
		"    contrast  mean over the shadow of |ratio - true ratio|, weighted by the light behind it\n"
		"Errors are in 8-bit levels of sRGB, over the pixels that the object changes; the thesis's in\n"
		"levels of linear light, as it has no transfer function. Without lightings: overcast, a sun, random\n"
		"ones, and single cells, of which the worst counts. White ground has radiance 1, in a panorama 0.6.",
	.options = rows,
	.run = bench_command,
};
