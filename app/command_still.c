/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/settings.h"
#include "app/still.h"
#include "hal/base/log.h"
#include "hal/compositor/compositor.h"
#include "hal/image/image.h"

struct still_options {
	struct settings settings;
	const char *basis, *background, *fisheye, *lights, *lights_out, *out;
	struct ini_level threshold; /* value NAN: as configured */
	int pose;		    /* -1: as configured */
	int mode;		    /* -1: as configured */
};

static int take_threshold(void *field, const char *option, const char *text, struct fault *fault)
{
	if (!ini_level_read(text, 255, field))
		return 0;
	return fault_say(fault, -EINVAL,
			 "%s: \"%s\", expected a grey level 0..255 or a percentage 0%%..100%%",
			 option, text);
}

#define AT(field) .place = offsetof(struct still_options, field)

static const struct option_row rows[] = {
	SETTINGS_ROWS,
	{"basis", OPTION_TEXT, AT(basis), .argument = "FILE",
	 .help = "the basis file; else the configuration's"},
	{"background", OPTION_TEXT, AT(background), .argument = "IMG",
	 .help = "the background camera's picture, 8-bit"},
	{"fisheye", OPTION_TEXT, AT(fisheye), .argument = "IMG",
	 .help = "the fisheye camera's picture, 8-bit or linear (.hdr, .pfm, .exr)"},
	{"lights", OPTION_TEXT, AT(lights), .argument = "FILE",
	 .help = "light colours instead of a fisheye: a line of \"r g b\" for each light, in dome order"},
	{"lights-out", OPTION_TEXT, AT(lights_out), .argument = "FILE",
	 .help = "write the measured light colours"},
	{"threshold", OPTION_OTHER, AT(threshold), .take = take_threshold, .argument = "LEVEL",
	 .help = "leave out lights below this grey level, 0..255, or what changes no pixel by more of white: 1%"},
	{"pose", OPTION_INT, AT(pose), .max = 65535, .argument = "N",
	 .help = "which pose of the basis, from 0"},
	{"mode", OPTION_CHOICE, AT(mode), .choices = still_mode_names, .argument = "MODE",
	 .help = "fast or exact, as [composite] mode; reference: in double precision, exact where the basis is"},
	{"out", OPTION_TEXT, AT(out), .argument = "FILE",
	 .help = "where the picture goes: .png, .pfm or .hdr"},
	{.name = NULL}};

/* What is wrong with the usage, or NULL. */
static const char *still_wrong(const struct still_options *o)
{
	if (o->out && image_name_linear(o->out, NULL) < 0)
		return "-o: expected a name that ends in .png, .pfm or .hdr";
	if (!o->background)
		return "--background IMG is missing";
	if (!o->out)
		return "-o FILE is missing";
	return !o->fisheye == !o->lights ? "expected one of --fisheye IMG and --lights FILE" : NULL;
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
		.pose = o->pose < 0 ? config->basis.pose : o->pose,
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

static int still_command_run(const struct command *command, int argc, char **argv)
{
	struct still_options options = {.threshold = {.value = NAN}, .pose = -1, .mode = -1};
	struct ini_report report = {.count = 0};
	struct config *config = NULL;
	int code = command_read_all(command, argc, argv, rows, &options), err;

	if (code != COMMAND_GOES_ON)
		return code;
	if (still_wrong(&options))
		return command_wrong(command, "%s", still_wrong(&options));
	err = settings_read(&options.settings, &config, &report);
	if (!err)
		err = run_config(&options, config, &report.first);
	if (err)
		log_error("%s", report.first.text);
	config_destroy(config);
	return err ? EXIT_FAILURE : EXIT_SUCCESS;
}

const struct command command_still = {
	.name = "still",
	.usage = "--basis FILE --background IMG (--fisheye IMG | --lights FILE) -o OUT",
	.summary = "one picture through the pipeline, from files to a file",
	.help = "\nA .png holds 8-bit code values; a .pfm or .hdr the linear light that they stand for, not\n"
		"rounded in reference mode. [fisheye] and [background] of the configuration say how the\n"
		"pictures are to be read: lens, view, transfer.\n",
	.run = still_command_run,
};
