/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/grab.h"
#include "app/settings.h"
#include "hal/base/log.h"

#define VALUE_MAX 64 /* bytes of a control's value, with its NUL */

struct grab_options {
	struct settings settings;
	const char *name, *out;
	struct option_list controls; /* NAME=VALUE or NAME=VALUE,VALUE... */
	bool as_sent;
};

#define AT(field) .place = offsetof(struct grab_options, field)

static const struct option_row rows[] = {
	SETTINGS_ROWS,
	{"control", OPTION_LIST, AT(controls), .argument = "NAME=VALUE",
	 .help = "set a control of the camera first, as inlay devices lists them; with several values, separated by commas, a picture is taken of each"},
	{"as-sent", OPTION_FLAG, AT(as_sent),
	 .help = "the camera's whole picture, not turned upright"},
	{"out", OPTION_TEXT, AT(out), .argument = "FILE.png",
	 .help = "the picture; %d in it becomes the control's value"},
	{.name = NULL}};

/* Splits the next value off a control's list. False: there is none. */
static bool next_value(const char **list, char value[VALUE_MAX])
{
	const size_t length = strcspn(*list, ",");

	if (!**list)
		return false;
	snprintf(value, VALUE_MAX, "%.*s", (int)length, *list);
	*list += length + ((*list)[length] == ',');
	return true;
}

static int set_control(struct grab *grab, const char *control, const char *value,
		       struct fault *fault)
{
	char name[128];

	snprintf(name, sizeof(name), "%.*s", (int)strcspn(control, "="), control);
	return grab_control(grab, name, value, fault);
}

/* Writes the name of a picture, with value in place of %d. */
static void name_picture(const char *out, const char *value, char *path, size_t room)
{
	const char *place = strstr(out, "%d");

	if (place)
		snprintf(path, room, "%.*s%s%s", (int)(place - out), out, value, place + 2);
	else
		snprintf(path, room, "%s", out);
}

static int write_picture(struct grab *grab, const char *out, const char *value, struct fault *fault)
{
	char path[INI_PATH_MAX];
	struct image image = {.u8 = NULL};
	int err = grab_take(grab, &image, fault);

	name_picture(out, value, path, sizeof(path));
	if (!err)
		err = image_write(path, &image, fault);
	if (!err)
		printf("%s: %dx%d\n", path, image.width, image.height);
	image_free(&image);
	return err;
}

/* The control that has several values; -1: none has. */
static int find_series(const struct grab_options *options)
{
	for (int i = 0; i < options->controls.count; i++)
		if (strchr(options->controls.text[i], ','))
			return i;
	return -1;
}

static int take_pictures(struct grab *grab, const struct grab_options *options, struct fault *fault)
{
	const int series = find_series(options);
	char value[VALUE_MAX] = "0";
	const char *list;
	int err = 0;

	for (int i = 0; i < options->controls.count && !err; i++)
		if (i != series)
			err = set_control(grab, options->controls.text[i],
					  strchr(options->controls.text[i], '=') + 1, fault);
	if (err || series < 0)
		return err ? err : write_picture(grab, options->out, value, fault);
	list = strchr(options->controls.text[series], '=') + 1;
	while (!err && next_value(&list, value)) {
		err = set_control(grab, options->controls.text[series], value, fault);
		if (!err)
			err = write_picture(grab, options->out, value, fault);
	}
	return err;
}

static int grab_pictures(const struct grab_options *options, struct fault *fault)
{
	struct ini_report report = {.count = 0};
	struct config *config = NULL;
	struct grab *grab = NULL;
	int err = settings_read(&options->settings, &config, &report);

	if (err)
		*fault = report.first;
	else
		err = grab_open(&grab, config, options->name, options->as_sent, fault);
	if (!err)
		err = take_pictures(grab, options, fault);
	grab_close(grab);
	config_destroy(config);
	return err;
}

/* What is wrong with the usage, or NULL. */
static const char *grab_wrong(const struct grab_options *options)
{
	int series = 0;

	for (int i = 0; i < options->controls.count; i++) {
		const char *text = options->controls.text[i], *equals = strchr(text, '=');

		series += strchr(text, ',') != NULL;
		if (!equals || equals == text || !equals[1])
			return "--control: expected NAME=VALUE";
	}
	if (!options->out)
		return "no file, expected -o FILE.png";
	if (image_name_linear(options->out, NULL) != 0)
		return "-o: expected a name that ends in .png";
	if (series > 1)
		return "two controls with several values, expected one";
	return series && !strstr(options->out, "%d")
		       ? "one file for several pictures, expected a name with %d in it"
		       : NULL;
}

static int grab_run(const struct command *command, int argc, char **argv)
{
	struct grab_options options = {.name = NULL};
	struct fault fault = {.text = ""};
	int code = command_read(command, argc, argv, rows, &options);

	if (code != COMMAND_GOES_ON)
		return code;
	if (optind + 1 != argc)
		return command_wrong(
			command,
			"expected one view or camera: fisheye, background, scene, depth or a camera's name");
	options.name = argv[optind];
	if (grab_wrong(&options))
		return command_wrong(command, "%s", grab_wrong(&options));
	if (!grab_pictures(&options, &fault))
		return EXIT_SUCCESS;
	log_error("%s", fault.text);
	return EXIT_FAILURE;
}

const struct command command_grab = {
	.name = "grab",
	.usage =
		"fisheye|background|scene|depth|CAMERA -o FILE.png [--as-sent] [--control NAME=VALUE]...",
	.summary = "take a still picture of a camera, upright as the kiosk sees it",
	.help = "\nFor calibration and for placing the object, on the kiosk while inlay run does not use the camera:\n"
		"  inlay grab background -o background.png\n"
		"  inlay grab fisheye --control auto_exposure=1 \\\n"
		"      --control exposure_time_absolute=160,80,40,20 -o sky-%d.png\n",
	.run = grab_run,
};
