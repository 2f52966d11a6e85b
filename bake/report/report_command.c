/* SPDX-License-Identifier: MIT */
/* inlay-bake report: what each choice costs and brings, for a scene. */
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>

#include "bake/base/commands.h"
#include "bake/report/report.h"
#include "hal/base/log.h"
#include "hal/base/pool.h"
#include "hal/optics/dome.h"

#define AT(field) .place = offsetof(struct report_settings, field)

static const struct option_row options[] = {
	{"output", OPTION_TEXT, AT(folder)},
	{"panorama", OPTION_LIST, AT(panoramas)},
	{"size", OPTION_SIZE, AT(width)},
	{"samples", OPTION_INT, AT(samples), .min = 1, .max = 65536},
	{"truth-samples", OPTION_INT, AT(truth_samples), .min = 1, .max = 1 << 20},
	{"frequency", OPTION_INT, AT(most_frequency), .min = 1, .max = DOME_FREQUENCY_MAX},
	{"pose", OPTION_TEXT, AT(pose)},
	{"repeat", OPTION_INT, AT(repeat), .min = 1, .max = 1000},
	{"threads", OPTION_INT, AT(threads), .min = 1, .max = POOL_THREADS_MAX},
	{"quiet", OPTION_FLAG, AT(quiet)},
	{.name = NULL},
};

static int report_command_run(const struct command *command, int argc, char **argv)
{
	struct report_settings s = {.folder = NULL};
	struct fault fault = {.text = ""};
	const int status = command_read(command, argc, argv, options, &s);

	if (status != COMMAND_GOES_ON)
		return status;
	if (optind + 1 != argc)
		return command_wrong(command, "expected one scene file");
	if (!s.folder)
		return command_wrong(command, "-o DIR is missing");
	if (s.panoramas.count > REPORT_LIGHTINGS_MAX)
		return command_wrong(command, "--panorama: more than %d of them",
				     REPORT_LIGHTINGS_MAX);
	s.input = argv[optind];
	if (report_run(&s, &fault)) {
		log_error("%s", fault.text);
		return EXIT_FAILURE;
	}
	if (!s.quiet)
		printf("%s/report.html\n", s.folder);
	return EXIT_SUCCESS;
}

const struct command report_command = {
	.name = "report",
	.usage = "SCENE -o DIR [--panorama FILE]... [--size WxH]\n"
		 "           [--samples S] [--truth-samples S] [--frequency F] [--pose P]\n"
		 "           [--repeat N] [--threads T] [--quiet]",
	.summary = "speed against error of a scene: one page with tables and CSVs",
	.help = "\n"
		"  -o DIR             the folder: report.html, and its pictures and tables as files;\n"
		"                     appears when it is whole\n"
		"  --panorama FILE    a surrounding, equirectangular in linear light; may be given\n"
		"                     again; else skies and a room that inlay makes itself\n"
		"  --size WxH         of the pictures that are baked and traced, 96x72\n"
		"  --samples S        camera rays a pixel of each bake, 16\n"
		"  --truth-samples S  of the truth, 256\n"
		"  --frequency F      of the finest dome that is tried, 1 to 72; 18\n"
		"  --pose P           of the scene: number, from 0, or name; 0\n"
		"  --repeat N         how often each frame is timed, 9\n"
		"  --threads T        that bake and trace; one for each processor\n"
		"  --quiet            print nothing but errors\n\n"
		"It says what each choice costs in time and memory, and how far the picture is then\n"
		"from double precision and from path-traced truth: number of lights, samples,\n"
		"declared error, column cut, threshold, beside each other in one table.\n"
		"What the scene file says is the setting in use; each other row names the line of the\n"
		"scene file or of the kiosk's configuration that makes it. Those are marked than which\n"
		"no other is better, as far as noise lets see.\n"
		"It takes some minutes. `inlay bench` measures a basis file, threads and kernels.\n",
	.run = report_command_run,
};
