/* SPDX-License-Identifier: MIT */
/* inlay-calibrate light: what a camera's code values mean. */
#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/commands.h"
#include "bake/calibrate/light_job.h"
#include "bake/calibrate/response/light_file.h"
#include "hal/base/log.h"

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

static int read_reflectance(void *field, const char *option, const char *text, struct fault *fault)
{
	double *reflectance = field;
	const int count = option_reals(option, text, 1, 3, 0, 1, reflectance, fault);

	if (count == 1)
		reflectance[1] = reflectance[2] = reflectance[0];
	for (int c = 0; count > 0 && c < 3; c++)
		if (count == 2 || !(reflectance[c] > 0 && reflectance[c] <= 1))
			return fault_say(fault, -EINVAL,
					 "%s: expected one number or three, above 0 and at most 1",
					 option);
	return count < 0 ? count : 0;
}

static int read_area(void *field, const char *option, const char *text, struct fault *fault)
{
	struct light_areas *list = field;
	struct fault why = {.text = ""};

	if (list->count == LIGHT_AREAS_MAX)
		return fault_say(fault, -EINVAL, "%s: expected at most %d of them", option,
				 LIGHT_AREAS_MAX);
	if (light_area_parse(&list->area[list->count++], text, &why) < 0)
		return fault_say(fault, -EINVAL, "%s: %s", option, why.text);
	return 0;
}

static int read_times(void *field, const char *option, const char *text, struct fault *fault)
{
	struct light_job *job = field;

	job->times = option_reals(option, text, 1, LIGHT_EXPOSURES_MAX, 0, 1e12, job->time, fault);
	return job->times < 0 ? job->times : 0;
}

#define AT(field) .place = offsetof(struct light_job, field)

static const struct option_row options[] = {
	{"times", OPTION_OTHER, .take = read_times},
	{"time-deviation", OPTION_REAL, AT(time_deviation), .min = 0, .max = 0.5},
	{"accept-misfit", OPTION_REAL, AT(misfit_percent), .min = 0.01, .max = 100},
	{"curve", OPTION_TEXT, AT(curve)},
	{"lens", OPTION_TEXT, AT(lens)},
	{"background-light", OPTION_TEXT, AT(background_light)},
	{"reflectance", OPTION_OTHER, AT(reflectance), .take = read_reflectance},
	{"patch", OPTION_OTHER, AT(patch), .take = read_area},
	{"background-patch", OPTION_OTHER, AT(background_patch), .take = read_area},
	{"fisheye", OPTION_TEXT, AT(fisheye)},
	{"background", OPTION_TEXT, AT(background)},
	{"report", OPTION_TEXT, AT(report)},
	{"output", OPTION_TEXT, AT(output)},
	{.name = NULL},
};

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

static int light_run(const struct command *command, int argc, char **argv)
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
	status = command_read(command, argc, argv, options, &job);
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

const struct command light_command = {
	.name = "light",
	.usage = "black|response|merge|gain|colours [options] FILES -o LIGHT.ini",
	.summary = "what a camera's code values mean: black level, response, gain, colours",
	.help = "Each adds its key to LIGHT.ini and keeps the others; [fisheye] light and [background] light of the\n"
		"kiosk's configuration name such files. Pictures are 8-bit (PNG, JPEG), upright and cut as the view is.\n"
		"\n  black COVERED               the lens covered\n"
		"  response [--times T,T,...] PICTURES\n"
		"                              one static scene; times in any unit, in the pictures' order;\n"
		"                              without, as the pictures say (EXIF)\n"
		"      --time-deviation X      times may be off by so much of themselves (0.02): refined\n"
		"      --accept-misfit P%      trust a curve that may be off by so much (5): real cameras'\n"
		"                              exposures agree to some per cent\n"
		"  response FILE.rsp           hdrgen's\n"
		"  merge [--times T,T,...] PICTURES -o FILE.hdr\n"
		"                              exposures as one picture of linear light, or .pfm\n"
		"      --curve FILE            LIGHT.ini or FILE.rsp; else sRGB\n"
		"  gain --lens EYE.ini --patch AREA FISHEYE BACKGROUND [FISHEYE BACKGROUND]...\n"
		"                              LIGHT.ini is the fisheye's; AREA lies level in the background\n"
		"      --background-light F    the background camera's LIGHT.ini; else sRGB\n"
		"      --reflectance X[,G,B]   of the area: 0.5\n"
		"  colours PATCHES             lines of r g b (fisheye) r g b (background), linear\n"
		"  colours --fisheye F --background B --patch AREA --background-patch AREA ...\n\n"
		"  AREA is x,y,width,height or corners \"x,y x,y x,y\", in pixels.\n"
		"  --report DIR                what was found, as a page; and light.json\n",
	.run = light_run,
};
