/* SPDX-License-Identifier: MIT */
/* inlay-bake sky: the parts of a dome that should be finer under a sky. */
#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/base/commands.h"
#include "bake/sky/sky_eye.h"
#include "bake/sky/sky_parts.h"
#include "bake/sky/sun.h"
#include "hal/base/log.h"
#include "hal/base/number.h"
#include "hal/base/output.h"
#include "hal/colour/response.h"

struct sky_choices {
	const char *output, *lens, *light;
	char **file;
	int files;
	int frequency, most, transfer, times;
	double time[EXPOSURES_MAX];
	double turn_deg;
	bool sun, north, dates, hours; /* these were given */
	struct sun_path path;
};

static int read_dates(void *field, const char *option, const char *text, struct fault *fault)
{
	struct sun_path *path = field;
	int end = -1;

	(void)sscanf(text, "%2d-%2d..%2d-%2d%n", &path->from.month, &path->from.day,
		     &path->to.month, &path->to.day, &end);
	if (end < 0 || text[end] || sun_day(path->from) < 0 || sun_day(path->to) < 0)
		return fault_say(
			fault, -EINVAL,
			"%s: is \"%s\", expected month-day..month-day, such as 04-01..09-30",
			option, text);
	return 0;
}

static int read_hours(void *field, const char *option, const char *text, struct fault *fault)
{
	const char *dots = strstr(text, "..");
	double *hours = field;
	char first[32];

	snprintf(first, sizeof(first), "%.*s", dots ? (int)(dots - text) : 0, text);
	if (!number_of(first, &hours[0]) && !number_of(dots + 2, &hours[1]) && hours[0] >= 0 &&
	    hours[0] < hours[1] && hours[1] <= 24)
		return 0;
	return fault_say(fault, -EINVAL,
			 "%s: is \"%s\", expected hours..hours of one day, such as 8..17.5", option,
			 text);
}

static int read_times(void *field, const char *option, const char *text, struct fault *fault)
{
	struct sky_choices *c = field;

	c->times = option_reals(option, text, 1, EXPOSURES_MAX, 0, 1e12, c->time, fault);
	return c->times < 0 ? c->times : 0;
}

#define AT(field) .place = offsetof(struct sky_choices, field)
#define GIVES(field) .given = offsetof(struct sky_choices, field)

static const struct option_row options[] = {
	{"output", OPTION_TEXT, AT(output)},
	{"frequency", OPTION_INT, AT(frequency), .min = 1, .max = DOME_FREQUENCY_MAX / 2},
	{"turn", OPTION_REAL, AT(turn_deg), .min = -360, .max = 360},
	{"most", OPTION_INT, AT(most), .min = 1, .max = DOME_LIGHTS_MAX},
	{"fisheye", OPTION_TEXT, AT(lens)},
	{"light", OPTION_TEXT, AT(light)},
	{"transfer", OPTION_CHOICE, AT(transfer), .choices = transfer_names},
	{"times", OPTION_OTHER, .take = read_times},
	{"sun", OPTION_REAL, AT(path.latitude_deg), .min = -90, .max = 90, GIVES(sun)},
	{"north", OPTION_REAL, AT(path.north_deg), .min = -360, .max = 360, GIVES(north)},
	{"dates", OPTION_OTHER, AT(path), .take = read_dates, GIVES(dates)},
	{"hours", OPTION_OTHER, AT(path.hours), .take = read_hours, GIVES(hours)},
	{.name = NULL},
};

static int add_panorama(struct sky_need *need, const struct sky_choices *c, struct fault *fault)
{
	struct image picture = {.width = 0};
	const struct panorama panorama = {
		.image = &picture, .turn_rad = c->turn_deg * (M_PI / 180), .scale = 1};
	const int err = panorama_read(&picture, c->file[0], fault);

	if (!err)
		sky_need_add_panorama(need, &panorama);
	image_free(&picture);
	return err;
}

/* Adds the fisheye's pictures, the longest exposure first. */
static int add_fisheye(struct sky_need *need, const struct sky_choices *c, struct fault *fault)
{
	struct sky_eye_settings settings = {.exposures = c->files};
	struct ini_report report = {.count = 0};
	struct response measured;
	double time[EXPOSURES_MAX];
	char *path[EXPOSURES_MAX];
	int err = sky_eye_lens(&settings.lens, c->lens, fault);

	if (err)
		return err;
	response_begin(&measured);
	if (c->light && response_read(&measured, c->light, &report))
		return fault_say(fault, -EINVAL, "%s", report.first.text);
	settings.curve = response_curve(&measured, (enum transfer)c->transfer, 0);
	for (int k = 0; k < c->files; k++) {
		int at = k;

		for (; at > 0 && time[at - 1] < c->time[k]; at--) {
			time[at] = time[at - 1];
			path[at] = path[at - 1];
		}
		time[at] = c->time[k];
		path[at] = c->file[k];
	}
	for (int k = 0; k < c->files; k++)
		settings.ratio[k] = k ? time[k] / time[0] : 1;
	return sky_need_add_pictures(need, &settings, path, fault);
}

/* Where the light is from, for the list's first line. */
static void say_source(const struct sky_choices *c, char *text, size_t room)
{
	int length = 0;

	for (int k = 0; k < c->files && (size_t)length < room; k++)
		length += snprintf(text + length, room - (size_t)length, "%s%s", k ? ", " : "",
				   c->file[k]);
	if (c->turn_deg != 0 && (size_t)length < room)
		length += snprintf(text + length, room - (size_t)length, ", turned by %g degrees",
				   c->turn_deg);
	if (c->sun && (size_t)length < room)
		snprintf(text + length, room - (size_t)length,
			 "%ssun at latitude %g, %02d-%02d..%02d-%02d", c->files ? ", " : "",
			 c->path.latitude_deg, c->path.from.month, c->path.from.day,
			 c->path.to.month, c->path.to.day);
}

static int run_sky(const struct sky_choices *c, struct fault *fault)
{
	struct sky_need need = {.levels = 0};
	struct sky_parts parts = {.count = 0};
	char what[1024] = "";
	int err = output_check(&c->output, 1, (const char *const *)c->file, c->files, fault);

	if (!err)
		err = sky_need_create(&need, c->frequency, fault);
	if (!err && c->lens)
		err = add_fisheye(&need, c, fault);
	else if (!err && c->files)
		err = add_panorama(&need, c, fault);
	if (!err && c->sun && !sky_need_add_sun(&need, &c->path))
		err = fault_say(fault, -EINVAL,
				"--sun: it is below the horizon at all these dates and hours");
	say_source(c, what, sizeof(what));
	if (!err)
		err = sky_parts_choose(&parts, &need, c->most, fault);
	if (!err)
		err = sky_parts_write(&parts, &need, what, c->output, fault);
	if (!err && parts.limited)
		log_info("%s: would be finer with more than %d lights", c->output, c->most);
	else if (!err && !parts.count)
		log_info("%s: no light is strong and small: a whole dome does", c->output);
	sky_parts_free(&parts);
	sky_need_free(&need);
	return err;
}

/* What is wrong with the options, or NULL. */
static const char *sky_wrong(const struct sky_choices *c)
{
	if (!c->lens && (c->light || c->times || c->transfer))
		return "--light, --times and --transfer go with --fisheye";
	if (c->lens && c->turn_deg != 0)
		return "--turn goes with a panorama; a fisheye is turned by its lens file";
	if (c->lens && !c->files)
		return "expected pictures of the fisheye";
	if (c->lens && c->files > 1 && c->times != c->files)
		return "expected as many --times as pictures, 5 at most";
	for (int k = 0; k < c->times; k++)
		for (int other = 0; other < k; other++)
			if (!(c->time[k] > 0 && c->time[other] > 0) || c->time[k] == c->time[other])
				return "--times: expected exposures above 0, each another one";
	if (!c->lens && c->files != 1 && !(c->sun && !c->files))
		return "expected one panorama";
	if ((c->north || c->dates || c->hours) && !c->sun)
		return "--north, --dates and --hours go with --sun";
	if (c->sun && !c->north)
		return "--north is missing";
	return c->output ? NULL : "-o FINE is missing";
}

static int sky_command_run(const struct command *command, int argc, char **argv)
{
	struct sky_choices c = {
		.frequency = 9,
		.most = 1000,
		.time = {1},
		.path = {.from = {1, 1}, .to = {12, 31}, .hours = {0, 24}},
	};
	struct fault fault = {.text = ""};
	const int status = command_read(command, argc, argv, options, &c);
	const char *wrong;

	if (status != COMMAND_GOES_ON)
		return status;
	c.file = argv + optind;
	c.files = argc - optind;
	wrong = sky_wrong(&c);
	if (wrong)
		return command_wrong(command, "%s", wrong);
	if (run_sky(&c, &fault) < 0) {
		log_error("%s", fault.text);
		return EXIT_FAILURE;
	}
	return EXIT_SUCCESS;
}

const struct command sky_command = {
	.name = "sky",
	.usage =
		"[PANORAMA | PICTURES --fisheye EYE.ini] [--sun LATITUDE --north DEG] [options] -o FINE",
	.summary = "choose where lights should be finer under a sky",
	.help = "\n  -o FINE         the list of parts, for \"fine\" in [dome] and for --fine\n"
		"  --frequency F   of the dome elsewhere, 1 to 36; 9\n"
		"  --most N        lights in all; 1000\n"
		"  --turn DEG      turn the panorama about the vertical, counter-clockwise\n\n"
		"PICTURES are upright pictures of a calibrated fisheye: one in linear light, or\n"
		"8-bit ones of one scene in different exposures. What all of them clip is a lamp.\n"
		"  --fisheye EYE.ini   its lens, as inlay-calibrate fisheye writes it\n"
		"  --times T,T,...     exposure of each, in any unit\n"
		"  --light LIGHT.ini   response and black level, as inlay-calibrate light writes them\n"
		"  --transfer T        where they are not measured; srgb\n\n"
		"Parts that the sun passes, with a picture or alone:\n"
		"  --sun LATITUDE      of the place, in degrees; south is negative\n"
		"  --north DEG         where north is in the scene: from +X towards +Y\n"
		"  --dates A..B        month-day, such as 04-01..09-30; the whole year\n"
		"  --hours A..B        true solar time, noon is 12; all day\n",
	.run = sky_command_run,
};
