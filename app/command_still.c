/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <math.h>
#include <string.h>

#include "app/commands.h"
#include "app/settings.h"
#include "app/still.h"
#include "hal/base/log.h"
#include "hal/compositor/compositor.h"
#include "hal/image/image.h"

struct still_options {
	struct settings settings; /* has to be first: SETTINGS_ROWS */
	const char *basis, *background, *fisheye, *lights, *lights_out, *out;
	struct ini_level threshold; /* value NAN: as configured */
	long pose;		    /* -1: as configured */
	int mode;		    /* -1: as configured */
};

#define TAKE_PATH(field)                                                                           \
	static int take_##field(void *context, const char *argument, const char **expected)        \
	{                                                                                          \
		(void)expected;                                                                    \
		((struct still_options *)context)->field = argument;                               \
		return 0;                                                                          \
	}

TAKE_PATH(basis)
TAKE_PATH(background)
TAKE_PATH(fisheye)
TAKE_PATH(lights)
TAKE_PATH(lights_out)

static int take_out(void *context, const char *argument, const char **expected)
{
	*expected = "a name that ends in .png, .pfm or .hdr";
	if (image_name_linear(argument, NULL) < 0)
		return -EINVAL;
	((struct still_options *)context)->out = argument;
	return 0;
}

static int take_threshold(void *context, const char *argument, const char **expected)
{
	*expected = "a grey level 0..255 or a percentage 0%..100%";
	return ini_level_read(argument, 255, &((struct still_options *)context)->threshold);
}

static int take_pose(void *context, const char *argument, const char **expected)
{
	*expected = "a whole number of at least 0";
	return option_integer(argument, 0, 65535, &((struct still_options *)context)->pose);
}

static int take_mode(void *context, const char *argument, const char **expected)
{
	*expected = "fast, exact or reference";
	for (int i = 0; still_mode_names[i]; i++) {
		if (!strcmp(still_mode_names[i], argument)) {
			((struct still_options *)context)->mode = i;
			return 0;
		}
	}
	return -EINVAL;
}

static const struct option_row rows[] = {
	SETTINGS_ROWS,
	{.name = "basis",
	 .argument = "FILE",
	 .help = "the basis file; else the configuration's",
	 .take = take_basis},
	{.name = "background",
	 .argument = "IMG",
	 .help = "the background camera's picture, 8-bit",
	 .take = take_background},
	{.name = "fisheye",
	 .argument = "IMG",
	 .help = "the fisheye camera's picture, 8-bit or linear (.hdr, .pfm, .exr)",
	 .take = take_fisheye},
	{.name = "lights",
	 .argument = "FILE",
	 .help = "light colours instead of a fisheye: a line of \"r g b\" for each light, in dome order",
	 .take = take_lights},
	{.name = "lights-out",
	 .argument = "FILE",
	 .help = "write the measured light colours",
	 .take = take_lights_out},
	{.name = "threshold",
	 .argument = "LEVEL",
	 .help = "leave out lights below this grey level, 0..255, or what changes no pixel by more of white: 1%",
	 .take = take_threshold},
	{.name = "pose",
	 .argument = "N",
	 .help = "which pose of the basis, from 0",
	 .take = take_pose},
	{.name = "mode",
	 .argument = "MODE",
	 .help = "fast or exact, as [composite] mode; reference: in double precision, exact where the basis is",
	 .take = take_mode},
	{.name = "out",
	 .letter = 'o',
	 .argument = "FILE",
	 .help = "where the picture goes: .png, .pfm or .hdr",
	 .take = take_out},
	{.name = NULL}};

static int still_is_misused(const struct still_options *o)
{
	const char *missing = !o->background ? "--background IMG" : !o->out ? "-o FILE" : NULL;

	if (missing) {
		log_error("still: %s is missing", missing);
		return EXIT_USAGE;
	}
	if (!o->fisheye == !o->lights) {
		log_error("still: expected one of --fisheye IMG and --lights FILE");
		return EXIT_USAGE;
	}
	return 0;
}

static int run_config(const struct still_options *o, const struct config *config,
		      struct fault *fault)
{
	struct still_settings settings = {
		.config = config,
		.basis = o->basis ? o->basis : config->basis.file,
		.background = o->background,
		.fisheye = o->fisheye,
		.lights = o->lights,
		.lights_out = o->lights_out,
		.out = o->out,
		.threshold = isnan(o->threshold.value) ? config->lights.threshold : o->threshold,
		.pose = o->pose < 0 ? config->basis.pose : (int)o->pose,
		.mode = o->mode >= 0				     ? (enum still_mode)o->mode
			: config->composite.mode == COMPOSITOR_EXACT ? STILL_EXACT
								     : STILL_FAST,
	};

	if (!*settings.basis)
		return fault_say(
			fault, -EINVAL,
			"still: no basis file, expected --basis FILE or [basis] file in the configuration");
	return still_run(&settings, fault);
}

static int still_command(int argc, char **argv)
{
	struct still_options options = {.threshold = {.value = NAN}, .pose = -1, .mode = -1};
	struct ini_report report = {.count = 0};
	struct config *config = NULL;
	int code = options_read(&command_still, argc, argv, &options), err;

	if (code != OPTIONS_GO_ON)
		return code;
	if (still_is_misused(&options))
		return EXIT_USAGE;
	err = settings_read(&options.settings, &config, &report);
	if (!err)
		err = run_config(&options, config, &report.first);
	if (err)
		log_error("%s", report.first.text);
	config_destroy(config);
	return err ? EXIT_FAILED : EXIT_DONE;
}

const struct command command_still = {
	.name = "still",
	.usage = "--basis FILE --background IMG (--fisheye IMG | --lights FILE) -o OUT",
	.purpose = "one picture through the pipeline, from files to a file",
	.details =
		"A .png holds 8-bit code values; a .pfm or .hdr the linear light that they stand for, not\n"
		"rounded in reference mode. [fisheye] and [background] of the configuration say how the\n"
		"pictures are to be read: lens, view, transfer.",
	.options = rows,
	.run = still_command,
};
