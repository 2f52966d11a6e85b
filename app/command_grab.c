/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "app/commands.h"
#include "app/grab.h"
#include "app/settings.h"
#include "hal/base/log.h"

#define CONTROLS_MAX 16
#define VALUE_MAX 64 /* bytes of a control's value, with its NUL */

struct grab_options {
	struct settings settings; /* has to be first: SETTINGS_ROWS */
	const char *name, *out;
	const char *controls[CONTROLS_MAX]; /* NAME=VALUE or NAME=VALUE,VALUE... */
	int control_count;
	bool as_sent;
};

static int take_out(void *context, const char *argument, const char **expected)
{
	*expected = "a name that ends in .png";
	if (image_name_linear(argument, NULL) != 0)
		return -EINVAL;
	((struct grab_options *)context)->out = argument;
	return 0;
}

static int take_control(void *context, const char *argument, const char **expected)
{
	struct grab_options *options = context;
	const char *equals = strchr(argument, '=');

	*expected = "NAME=VALUE, at most 16 times";
	if (!equals || equals == argument || !equals[1] || options->control_count == CONTROLS_MAX)
		return -EINVAL;
	options->controls[options->control_count++] = argument;
	return 0;
}

static int take_as_sent(void *context, const char *argument, const char **expected)
{
	(void)argument;
	(void)expected;
	((struct grab_options *)context)->as_sent = true;
	return 0;
}

static int take_word(void *context, const char *word, const char **expected)
{
	struct grab_options *options = context;

	*expected = "one view or camera";
	if (options->name)
		return -EINVAL;
	options->name = word;
	return 0;
}

static const struct option_row rows[] = {
	SETTINGS_ROWS,
	{.name = "control",
	 .argument = "NAME=VALUE",
	 .help = "set a control of the camera first, as inlay devices lists them; with several values, separated by commas, a picture is taken of each",
	 .take = take_control},
	{.name = "as-sent",
	 .help = "the camera's whole picture, not turned upright",
	 .take = take_as_sent},
	{.name = "out",
	 .letter = 'o',
	 .argument = "FILE.png",
	 .help = "the picture; %d in it becomes the control's value",
	 .take = take_out},
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
	for (int i = 0; i < options->control_count; i++)
		if (strchr(options->controls[i], ','))
			return i;
	return -1;
}

static int take_pictures(struct grab *grab, const struct grab_options *options, struct fault *fault)
{
	const int series = find_series(options);
	char value[VALUE_MAX] = "0";
	const char *list;
	int err = 0;

	for (int i = 0; i < options->control_count && !err; i++)
		if (i != series)
			err = set_control(grab, options->controls[i],
					  strchr(options->controls[i], '=') + 1, fault);
	if (err || series < 0)
		return err ? err : write_picture(grab, options->out, value, fault);
	list = strchr(options->controls[series], '=') + 1;
	while (!err && next_value(&list, value)) {
		err = set_control(grab, options->controls[series], value, fault);
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

static int usage_fault(const struct grab_options *options)
{
	int series = 0;

	for (int i = 0; i < options->control_count; i++)
		series += strchr(options->controls[i], ',') != NULL;
	if (!options->name)
		log_error(
			"grab: no view, expected fisheye, background, scene, depth or a camera's name");
	else if (!options->out)
		log_error("grab: no file, expected -o FILE.png");
	else if (series > 1)
		log_error("grab: two controls with several values, expected one");
	else if (series && !strstr(options->out, "%d"))
		log_error("grab: one file for several pictures, expected a name with %%d in it");
	else
		return 0;
	return EXIT_USAGE;
}

static int grab_command(int argc, char **argv)
{
	struct grab_options options = {.name = NULL};
	struct fault fault = {.text = ""};
	int code = options_read(&command_grab, argc, argv, &options);

	if (code != OPTIONS_GO_ON)
		return code;
	code = usage_fault(&options);
	if (code)
		return code;
	if (!grab_pictures(&options, &fault))
		return EXIT_DONE;
	log_error("%s", fault.text);
	return EXIT_FAILED;
}

const struct command command_grab = {
	.name = "grab",
	.usage =
		"fisheye|background|scene|depth|CAMERA -o FILE.png [--as-sent] [--control NAME=VALUE]...",
	.purpose = "take a still picture of a camera, upright as the kiosk sees it",
	.details =
		"For calibration and for placing the object, on the kiosk while inlay run does not use the camera:\n"
		"  inlay grab background -o background.png\n"
		"  inlay grab fisheye --control auto_exposure=1 \\\n"
		"      --control exposure_time_absolute=160,80,40,20 -o sky-%d.png",
	.options = rows,
	.take_word = take_word,
	.run = grab_command,
};
