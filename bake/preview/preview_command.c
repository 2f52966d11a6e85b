/* SPDX-License-Identifier: MIT */
/* inlay-bake preview: the objects in a photograph of the place, within seconds, again and again. */
#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/base/commands.h"
#include "bake/base/watch.h"
#include "bake/preview/preview.h"
#include "hal/base/log.h"
#include "hal/optics/dome.h"

struct preview_choices {
	struct preview_settings preview;
	bool watch;
};

#define AT(field) .place = offsetof(struct preview_choices, field)

static const struct option_row options[] = {
	{"output", OPTION_TEXT, AT(preview.output)},
	{"background", OPTION_TEXT, AT(preview.background)},
	{"config", OPTION_TEXT, AT(preview.config)},
	{"lights", OPTION_TEXT, AT(preview.lights)},
	{"fisheye", OPTION_TEXT, AT(preview.fisheye)},
	{"frequency", OPTION_INT, AT(preview.frequency), .min = 1, .max = DOME_FREQUENCY_MAX},
	{"exposure", OPTION_REAL, AT(preview.exposure), .min = 1e-9, .max = 1e9},
	{"samples", OPTION_INT, AT(preview.samples), .min = 1, .max = 65536},
	{"pose", OPTION_TEXT, AT(preview.pose)},
	{"threads", OPTION_INT, AT(preview.threads), .min = 1, .max = 1024},
	{"watch", OPTION_FLAG, AT(watch)},
	{"quiet", OPTION_FLAG, AT(preview.quiet)},
	{.name = NULL},
};

/* Makes one picture. Returns the exit code. */
static int preview_once(const struct preview_settings *settings)
{
	struct fault fault = {.text = ""};
	const int err = preview_run(settings, &fault);

	fflush(stdout);
	if (!err)
		return EXIT_SUCCESS;
	log_error("%s", fault.text);
	return err == -ENODATA ? EXIT_MISSED : EXIT_FAILURE;
}

/* Makes a picture of each state of the files, and goes on until it is ended. An error is said, and
 * leaves the picture before. */
static int preview_watch(const struct preview_settings *settings)
{
	struct fault fault = {.text = ""};
	struct watch *watch;
	int err = watch_create(&watch, &fault);

	if (err) {
		log_error("%s", fault.text);
		return EXIT_FAILURE;
	}
	while (!err) {
		watch_begin(watch);
		(void)preview_once(settings);
		err = watch_end(watch, &fault);
		if (!err && watch_wait(watch, -1, &fault) < 0)
			err = -EIO;
	}
	log_error("%s", fault.text);
	watch_destroy(watch);
	return EXIT_FAILURE;
}

static int preview_command_run(const struct command *command, int argc, char **argv)
{
	struct preview_choices c = {.preview = {.frequency = -1, .exposure = 1}};
	struct fault fault = {.text = ""};
	const int status = command_read(command, argc, argv, options, &c);

	if (status != COMMAND_GOES_ON)
		return status;
	if (optind + 1 != argc)
		return command_wrong(command, "expected one scene file");
	if (!c.preview.background)
		return command_wrong(command, "--background IMG is missing");
	if (!c.preview.output)
		return command_wrong(command, "-o OUT.png is missing");
	if (c.preview.lights && c.preview.fisheye)
		return command_wrong(command, "--lights and --fisheye exclude each other");
	if (c.preview.fisheye && !c.preview.config)
		return command_wrong(command, "--fisheye goes with --config, which has its lens");
	if (c.preview.frequency >= 0 && !c.preview.lights && !c.preview.fisheye)
		return command_wrong(command, "--frequency goes with --lights and --fisheye");
	c.preview.scene = argv[optind];
	if (preview_check(&c.preview, &fault)) {
		log_error("%s", fault.text);
		return EXIT_FAILURE;
	}
	return c.watch ? preview_watch(&c.preview) : preview_once(&c.preview);
}

const struct command preview_command = {
	.name = "preview",
	.usage = "SCENE --background IMG -o OUT.png [options]",
	.summary = "show the object in a photograph of the place, within seconds",
	.help = "\n"
		"  --background IMG  what the camera sees: upright, as inlay grab takes it, and of\n"
		"                    the camera's size\n"
		"  -o FILE           .png: code values like the photograph's; .pfm, .hdr: linear light\n"
		"  --watch           make it again whenever the scene file or a file that it names changes,\n"
		"                    until ended; the picture is replaced whole\n"
		"  --config FILE     the kiosk's: [fisheye] and [background] without their views, and [composite]\n"
		"                    gain; else sRGB and 1\n"
		"  --lights FILE     light colours, as inlay still --lights-out writes them\n"
		"  --fisheye IMG     or what the fisheye sees, upright; else the sky is even\n"
		"  --frequency F     of the dome whose lights these are; else that of the scene\n"
		"  --exposure E      radiance of the even sky, or of 1 in the light; 1\n"
		"  --samples S       camera rays a pixel; else as many as take seconds\n"
		"  --pose P          of the scene: number, from 0, or name\n"
		"  --threads T       default: one for each processor\n"
		"  --quiet           print nothing but errors\n\n"
		"Exit code 3: the camera sees no object, and there is no picture.\n",
	.run = preview_command_run,
};
