/* SPDX-License-Identifier: MIT */
/* inlay-calibrate light: what a camera's code values mean. */
#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/commands.h"
#include "bake/calibrate/light_commands.h"
#include "bake/calibrate/response/light_file.h"
#include "hal/base/log.h"

enum {
	TIMES = 1,
	TIME_DEVIATION,
	ACCEPT_MISFIT,
	EXPOSURES,
	KEEP_WHITE,
	WHITE_BALANCE,
	CURVE,
	LENS,
	BACKGROUND_LIGHT,
	TRANSFER,
	BACKGROUND_TRANSFER,
	REFLECTANCE,
	PATCH,
	BACKGROUND_PATCH,
	FISHEYE,
	BACKGROUND,
	REPORT
};

static const struct option options[] = {
	{"times", required_argument, NULL, TIMES},
	{"time-deviation", required_argument, NULL, TIME_DEVIATION},
	{"accept-misfit", required_argument, NULL, ACCEPT_MISFIT},
	{"exposures", no_argument, NULL, EXPOSURES},
	{"keep-white", no_argument, NULL, KEEP_WHITE},
	{"white-balance", no_argument, NULL, WHITE_BALANCE},
	{"curve", required_argument, NULL, CURVE},
	{"lens", required_argument, NULL, LENS},
	{"background-light", required_argument, NULL, BACKGROUND_LIGHT},
	{"transfer", required_argument, NULL, TRANSFER},
	{"background-transfer", required_argument, NULL, BACKGROUND_TRANSFER},
	{"reflectance", required_argument, NULL, REFLECTANCE},
	{"patch", required_argument, NULL, PATCH},
	{"background-patch", required_argument, NULL, BACKGROUND_PATCH},
	{"fisheye", required_argument, NULL, FISHEYE},
	{"background", required_argument, NULL, BACKGROUND},
	{"report", required_argument, NULL, REPORT},
	{"output", required_argument, NULL, 'o'},
	OPTIONS_OF_ALL,
	{NULL, 0, NULL, 0},
};

static const struct {
	const char *name;
	int (*check)(const struct light_job *job, struct fault *fault);
	int (*run)(const struct light_job *job, struct fault *fault);
} commands[] = {
	{"black", light_check_black, light_command_black},
	{"response", light_check_response, light_command_response},
	{"gain", light_check_gain, light_command_gain},
	{"colours", light_check_colours, light_command_colours},
	{"merge", light_check_merge, light_command_merge},
};
#define COMMANDS (int)(sizeof(commands) / sizeof(commands[0]))

static int read_reflectance(struct light_job *job, struct fault *fault)
{
	const int count = option_reals("--reflectance", optarg, 1, 3, 0, 1, job->reflectance,
				       fault);

	if (count == 1)
		job->reflectance[1] = job->reflectance[2] = job->reflectance[0];
	for (int c = 0; count > 0 && c < 3; c++)
		if (count == 2 || !(job->reflectance[c] > 0 && job->reflectance[c] <= 1))
			return fault_say(fault, -EINVAL,
					 "--reflectance: expected one number or three, above 0 and "
					 "at most 1");
	return count < 0 ? count : 0;
}

static int read_area(struct light_area *list, int *count, const char *option, struct fault *fault)
{
	struct fault why = {.text = ""};

	if (*count == LIGHT_AREAS_MAX)
		return fault_say(fault, -EINVAL, "%s: expected at most %d of them", option,
				 LIGHT_AREAS_MAX);
	if (light_area_parse(&list[(*count)++], optarg, &why) < 0)
		return fault_say(fault, -EINVAL, "%s: %s", option, why.text);
	return 0;
}

static int read_value(struct light_job *job, int option, struct fault *fault)
{
	switch (option) {
	case TIMES:
		job->times = option_reals("--times", optarg, 1, LIGHT_EXPOSURES_MAX, 0, 1e12,
					  job->time, fault);
		return job->times < 0 ? job->times : 0;
	case TIME_DEVIATION:
		return option_real("--time-deviation", optarg, 0, 0.5, &job->time_deviation, fault);
	case ACCEPT_MISFIT:
		return option_real("--accept-misfit", optarg, 0.01, 100, &job->misfit_percent,
				   fault);
	case TRANSFER:
		return option_choice("--transfer", optarg, transfer_names, &job->transfer, fault);
	case BACKGROUND_TRANSFER:
		return option_choice("--background-transfer", optarg, transfer_names,
				     &job->background_transfer, fault);
	case REFLECTANCE:
		return read_reflectance(job, fault);
	case PATCH:
		return read_area(job->area, &job->areas, "--patch", fault);
	case BACKGROUND_PATCH:
		return read_area(job->background_area, &job->background_areas, "--background-patch",
				 fault);
	default:
		return 0;
	}
}

static void read_name(struct light_job *job, int option)
{
	switch (option) {
	case EXPOSURES:
		job->exposures = true;
		break;
	case KEEP_WHITE:
		job->keep_white = true;
		break;
	case WHITE_BALANCE:
		job->white_balance = true;
		break;
	case CURVE:
		job->curve = optarg;
		break;
	case LENS:
		job->lens = optarg;
		break;
	case BACKGROUND_LIGHT:
		job->background_light = optarg;
		break;
	case FISHEYE:
		job->fisheye = optarg;
		break;
	case BACKGROUND:
		job->background = optarg;
		break;
	case REPORT:
		job->report = optarg;
		break;
	case 'o':
		job->output = optarg;
		break;
	default:
		break;
	}
}

static int light_take_option(void *job, int option, struct fault *fault)
{
	read_name(job, option);
	return read_value(job, option, fault);
}

static int light_work(struct light_job *job, int which)
{
	struct fault fault = {.text = ""};
	/* what a merged picture held before does not matter */
	const bool keeps = job->output && commands[which].run != light_command_merge;
	int ret = keeps ? light_file_read(job->output, &job->measured, &fault) : 0;

	if (!keeps)
		response_begin(&job->measured);
	if (ret == 0)
		ret = commands[which].run(job, &fault);
	if (ret < 0)
		log_error("%s", fault.text);
	return ret ? EXIT_FAILURE : EXIT_SUCCESS;
}

static int light_run(const struct bake_command *command, int argc, char **argv)
{
	struct light_job job = {.reflectance = {0.5, 0.5, 0.5}};
	struct fault fault = {.text = ""};
	int which = 0, status;

	while (argc > 1 && which < COMMANDS && strcmp(commands[which].name, argv[1]) != 0)
		which++;
	if (argc > 1 && which < COMMANDS) {
		argc--;
		argv++;
	} else {
		which = -1;
	}
	status = command_options(command, argc, argv, options, light_take_option, &job);
	if (status != COMMAND_GOES_ON)
		return status;
	if (which < 0)
		return command_wrong(command,
				     "expected one of black, response, merge, gain, colours");
	job.files = argv + optind;
	job.file_count = argc - optind;
	if (job.output && light_is_rsp(job.output))
		return command_wrong(command, "-o %s: hdrgen's files are read, not written",
				     job.output);
	if (commands[which].check(&job, &fault))
		return command_wrong(command, "%s", fault.text);
	return light_work(&job, which);
}

const struct bake_command light_command = {
	.name = "light",
	.usage = "black|response|merge|gain|colours [options] FILES -o LIGHT.ini",
	.summary = "what a camera's code values mean: black level, response, gain, colours",
	.help = "Each adds its key to LIGHT.ini and keeps the others; [fisheye] light and "
		"[background] light of the\n"
		"kiosk's configuration name such files. Pictures are 8-bit (PNG, JPEG), upright "
		"and "
		"cut as the view is.\n\n"
		"  black COVERED               the lens covered\n"
		"  black --exposures A B       or the darkest places of two exposures, the shorter "
		"first\n"
		"  response [--times T,T,...] PICTURES\n"
		"                              one static scene; times in any unit, in the "
		"pictures' "
		"order;\n"
		"                              without, as the pictures say (EXIF)\n"
		"      --time-deviation X      times may be off by so much of themselves (0.02): "
		"refined\n"
		"      --accept-misfit P%      trust a curve that may be off by so much (5): real "
		"cameras'\n"
		"                              exposures agree to some per cent\n"
		"  response FILE.rsp           hdrgen's\n"
		"  merge [--times T,T,...] PICTURES -o FILE.hdr\n"
		"                              exposures as one picture of linear light, or .pfm\n"
		"      --curve FILE            LIGHT.ini or FILE.rsp; else --transfer (srgb)\n"
		"  gain --lens EYE.ini --patch AREA FISHEYE BACKGROUND [FISHEYE BACKGROUND]...\n"
		"                              LIGHT.ini is the fisheye's; AREA lies level in the "
		"background\n"
		"      --background-light FILE --background-transfer T --transfer T\n"
		"                              how the code values are decoded (srgb)\n"
		"      --reflectance X[,G,B]   of the area: 0.5\n"
		"      --white-balance         each channel's own gain becomes colours\n"
		"  colours PATCHES             lines of r g b (fisheye) r g b (background), "
		"linear\n"
		"  colours --fisheye F --background B --patch AREA --background-patch AREA ...\n"
		"      --keep-white            grey stays grey\n\n"
		"  AREA is x,y,width,height or corners \"x,y x,y x,y\", in pixels.\n"
		"  --report DIR                what was found, as a page; and light.json\n",
	.run = light_run,
};
