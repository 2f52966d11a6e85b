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

enum { PANORAMA = 1, SIZE, SAMPLES, TRUTH_SAMPLES, FREQUENCY, POSE, REPEAT, THREADS, QUIET };

static const struct option options[] = {
	{"output", required_argument, NULL, 'o'},
	{"panorama", required_argument, NULL, PANORAMA},
	{"size", required_argument, NULL, SIZE},
	{"samples", required_argument, NULL, SAMPLES},
	{"truth-samples", required_argument, NULL, TRUTH_SAMPLES},
	{"frequency", required_argument, NULL, FREQUENCY},
	{"pose", required_argument, NULL, POSE},
	{"repeat", required_argument, NULL, REPEAT},
	{"threads", required_argument, NULL, THREADS},
	{"quiet", no_argument, NULL, QUIET},
	OPTIONS_OF_ALL,
	{NULL, 0, NULL, 0},
};

static int take_panorama(struct report_settings *s, struct fault *fault)
{
	if (s->panoramas == REPORT_LIGHTINGS_MAX)
		return fault_say(fault, -1, "--panorama: more than %d of them",
				 REPORT_LIGHTINGS_MAX);
	s->panorama[s->panoramas++] = optarg;
	return 0;
}

static int report_command_take(void *choices, int option, struct fault *fault)
{
	struct report_settings *s = choices;

	switch (option) {
	case 'o':
		s->folder = optarg;
		return 0;
	case PANORAMA:
		return take_panorama(s, fault);
	case SIZE:
		return option_size("--size", optarg, &s->width, &s->height, fault);
	case SAMPLES:
		return option_int("--samples", optarg, 1, 65536, &s->samples, fault);
	case TRUTH_SAMPLES:
		return option_int("--truth-samples", optarg, 1, 1 << 20, &s->truth_samples, fault);
	case FREQUENCY:
		return option_int("--frequency", optarg, 1, DOME_FREQUENCY_MAX, &s->most_frequency,
				  fault);
	case POSE:
		s->pose = optarg;
		return 0;
	case REPEAT:
		return option_int("--repeat", optarg, 1, 1000, &s->repeat, fault);
	case THREADS:
		return option_int("--threads", optarg, 1, POOL_THREADS_MAX, &s->threads, fault);
	default:
		s->quiet = true;
		return 0;
	}
}

static int report_command_run(const struct command *command, int argc, char **argv)
{
	struct report_settings s = {.folder = NULL};
	struct fault fault = {.text = ""};
	const int status = command_options(command, argc, argv, options, report_command_take, &s);

	if (status != COMMAND_GOES_ON)
		return status;
	if (optind + 1 != argc)
		return command_wrong(command, "expected one scene file");
	if (!s.folder)
		return command_wrong(command, "-o DIR is missing");
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
	.summary = "speed against error of a scene: one page with a plot, tables and CSVs",
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
		"It takes some minutes. inlay run --stats says what a frame takes on a kiosk.\n",
	.run = report_command_run,
};
