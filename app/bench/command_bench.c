/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/bench/bench.h"
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

static int take_kernel(void *field, const char *option, const char *text, struct fault *fault)
{
	*(const char **)field = text;
	if (kernels_choose(text))
		return 0;
	return fault_say(
		fault, -EINVAL,
		"%s: \"%s\", expected auto, or the name of a kernel that this processor supports",
		option, text);
}

static int take_threshold(void *field, const char *option, const char *text, struct fault *fault)
{
	struct bench_settings *settings = field;
	struct ini_level level;

	if (ini_level_read(text, 255, &level))
		return fault_say(
			fault, -EINVAL,
			"%s: \"%s\", expected a grey level 0..255 or a percentage 0%%..100%%",
			option, text);
	settings->threshold = level.percent ? 0 : transfer_decode(TRANSFER_SRGB, level.value / 255);
	settings->budget = level.percent ? level.value / 100 : 0;
	return 0;
}

static int take_thesis(void *field, const char *option, const char *text, struct fault *fault)
{
	static const char *const names[] = {"no", "yes", NULL};
	int which = 0;
	const int err = option_choice(option, text, names, &which, fault);

	*(bool *)field = which;
	return err;
}

#define AT(field) .place = offsetof(struct bench_options, field)

static const struct option_row rows[] = {
	{"basis", OPTION_TEXT, AT(settings.basis), .argument = "FILE", .help = "the basis file"},
	{"kernel", OPTION_OTHER, AT(settings.kernel), .take = take_kernel, .argument = "NAME",
	 .help = "one kernel, or auto for the fastest; else each that the processor supports"},
	{"lights", OPTION_LIST, AT(settings.lights), .argument = "FILE",
	 .help = "a lighting: a line of \"r g b\" for each light, in dome order; may be given again"},
	{"panorama", OPTION_LIST, AT(settings.panoramas), .argument = "FILE",
	 .help = "a lighting: an equirectangular picture in linear light; may be given again"},
	{"cells", OPTION_INT, AT(settings.cells), .max = BASIS_LIGHTS_MAX, .argument = "N",
	 .help = "how many of the cells are lit alone where no lighting is given; 32"},
	{"threshold", OPTION_OTHER, AT(settings), .take = take_threshold, .argument = "LEVEL",
	 .help = "leave out lights below this grey level, 0..255, or what changes no pixel by more of white: 1%; 0 takes all"},
	{"threads", OPTION_INT, AT(settings.threads), .max = POOL_THREADS_MAX, .argument = "N",
	 .help = "threads that make a picture, 0 for one a processor; 1"},
	{"repeat", OPTION_INT, AT(settings.repeat), .min = 1, .max = 100000, .argument = "N",
	 .help = "how often each way is timed; 15"},
	{"thesis", OPTION_OTHER, AT(settings.thesis), .take = take_thesis, .argument = "YES|NO",
	 .help = "whether to run the thesis's algorithm too, which takes much memory; yes"},
	{"json", OPTION_FLAG, AT(json), .help = "every figure, for programs"},
	{"csv", OPTION_TEXT, AT(csv), .argument = "FILE",
	 .help = "write every figure of the table there too"},
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

static int bench_command_run(const struct command *command, int argc, char **argv)
{
	struct bench_options options = {
		.settings = {.threads = 1, .repeat = 15, .cells = 32, .thesis = true}};
	struct fault fault = {.text = ""};
	int code = command_read_all(command, argc, argv, rows, &options), err;

	if (code != COMMAND_GOES_ON)
		return code;
	if (!options.settings.basis)
		return command_wrong(command, "--basis FILE is missing");
	err = run_bench(&options, &fault);
	if (err)
		log_error("%s", fault.text);
	return err ? EXIT_FAILURE : EXIT_SUCCESS;
}

const struct command command_bench = {
	.name = "bench",
	.usage = "--basis FILE [--lights FILE]... [--panorama FILE]... [options]",
	.summary = "what a picture of a basis takes, and how exact it is, beside the thesis's way",
	.help = "\nOne row each, timed in turns on the same pixels under the same lights: the thesis's algorithm in\n"
		"double precision; the exact layer; the fast one; a whole frame from two YUYV cameras of the\n"
		"basis's size, and one with four lamps at places; copying the picture. Errors are the worst of all\n"
		"that the lighting holds.\n"
		"    x thesis  the thesis's median time over this one\n"
		"    x copy    the least time over that of copying the picture\n"
		"    PSNR, RMS, max   against double precision, not rounded: 8 bits alone are 58.9 dB\n"
		"    contrast  mean over the shadow of |ratio - true ratio|, weighted by the light behind it\n"
		"Errors are in 8-bit levels of sRGB, over the pixels that the object changes; the thesis's in\n"
		"levels of linear light, as it has no transfer function. Without lightings: overcast, a sun, random\n"
		"ones, and single cells, of which the worst counts. White ground has radiance 1, in a panorama 0.6.\n",
	.run = bench_command_run,
};
