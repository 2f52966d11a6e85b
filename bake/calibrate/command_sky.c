/* SPDX-License-Identifier: MIT */
/* inlay-calibrate sky: where light is ever strong and small, seen by the kiosk's fisheye. */
#include <errno.h>
#include <getopt.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bake/calibrate/commands.h"
#include "bake/calibrate/observe/live.h"
#include "bake/sky/sky_eye.h"
#include "bake/sky/sky_parts.h"
#include "hal/base/clock.h"
#include "hal/base/log.h"
#include "hal/base/number.h"
#include "hal/base/output.h"

#define TIMEOUT_MS 5000
#define RETRY_S 5   /* between two attempts to open a camera that was lost */
#define LOOK_S 1    /* between two pictures that are read */
#define MOMENT_S 10 /* pictures are averaged over it: a flash is no lamp, nor is noise */
#define SAVE_S 600
#define GAP_S 60 /* a longer gap between two pictures is none of the watch */
#define WATCH_S (24 * 3600)

struct watch {
	const char *output, *config;
	int frequency, most;
	double watch_s;
	struct sky_need need;
	double *sum; /* [pieces]: irradiance of the pictures of this moment */
	int pictures;
	/* By the camera's clock, without gaps: */
	int64_t last_ns; /* when the last picture was captured; 0: none yet */
	double seen_s, read_s, moment_s, saved_s;
	bool saved; /* or tried to */
};

static volatile sig_atomic_t watch_ends;

static void watch_end(int signal)
{
	(void)signal;
	watch_ends = 1;
}

/* ---- the list ---- */

/* "3 h 20 min", or seconds below a minute. */
static const char *watch_time(double seconds, char text[32])
{
	const int minutes = (int)(seconds / 60 + 1e-6);

	if (minutes < 1)
		snprintf(text, 32, "%.0f s", seconds);
	else if (minutes < 60)
		snprintf(text, 32, "%d min", minutes);
	else
		snprintf(text, 32, "%d h %d min", minutes / 60, minutes % 60);
	return text;
}

/* Writes the parts by all moments so far, and says how many there are. */
static int watch_save(struct watch *w, struct fault *fault)
{
	struct sky_parts parts;
	char what[1100], seen[32], whole[32];
	int err = sky_parts_choose(&parts, &w->need, w->most, fault);

	w->saved = true;
	w->saved_s = w->seen_s;
	if (err)
		return err;
	watch_time(w->seen_s, seen);
	snprintf(what, sizeof(what), "%s, watched for %s", w->config, seen);
	err = sky_parts_write(&parts, &w->need, what, w->output, fault);
	if (!err)
		log_info("%s of %s: %d part%s, %d lights%s", seen, watch_time(w->watch_s, whole),
			 parts.count, parts.count == 1 ? "" : "s", parts.lights,
			 parts.limited ? ", would be finer with more" : "");
	sky_parts_free(&parts);
	return err;
}

/* Makes a moment of the pictures since the last one. */
static void watch_finish_moment(struct watch *w)
{
	const size_t pieces = (size_t)sky_need_pieces(&w->need)->count;

	w->moment_s = w->seen_s;
	if (!w->pictures)
		return;
	for (size_t i = 0; i < pieces; i++)
		w->need.irradiance[i] = w->sum[i] / w->pictures;
	sky_need_add(&w->need, sky_eye_least());
	memset(w->sum, 0, pieces * sizeof(*w->sum));
	w->pictures = 0;
}

/* ---- pictures ---- */

static int watch_picture(struct watch *w, struct sky_eye *eye, const struct image *picture,
			 int64_t captured_ns, struct fault *fault)
{
	const double since_s = (double)(captured_ns - w->last_ns) / NS_PER_S;
	const bool first = !w->last_ns;
	int err;

	w->last_ns = captured_ns;
	w->seen_s += !first && since_s > 0 && since_s < GAP_S ? since_s : 0;
	if (first || w->seen_s >= w->read_s + LOOK_S) {
		w->read_s = w->seen_s;
		err = sky_eye_read(eye, picture, 0);
		if (err)
			return fault_say(fault, err, "the picture cannot be read: %s",
					 strerror(-err));
		sky_eye_gather(eye, &w->need, 1, w->sum);
		w->pictures++;
	}
	if (w->seen_s < w->moment_s + MOMENT_S)
		return 0;
	watch_finish_moment(w);
	/* What was seen is worth more than a list: a disk may be full for an hour. */
	if ((!w->saved || w->seen_s >= w->saved_s + SAVE_S) && watch_save(w, fault) < 0) {
		log_warning("%s: tried again in %d minutes", fault->text, SAVE_S / 60);
		*fault = (struct fault){.text = ""};
	}
	return 0;
}

/* Watches until the time is over, the camera is lost, or a signal comes. */
static int watch_camera(struct watch *w, struct fault *fault)
{
	struct sky_eye_settings settings = {.ratio = {1}, .exposures = 1};
	struct image picture = {.width = 0};
	struct sky_eye *eye = NULL;
	struct live *live;
	int64_t captured_ns;
	int err = live_open(&live, w->config, LIVE_FISHEYE, fault);

	if (!err)
		err = live_lens(live, &settings.lens, &settings.curve, fault);
	if (!err)
		err = sky_eye_create(&eye, sky_need_pieces(&w->need), &settings, live_width(live),
				     live_height(live), fault);
	while (!err && !watch_ends && w->seen_s < w->watch_s) {
		err = live_next(live, TIMEOUT_MS, &picture, &captured_ns, fault);
		if (!err)
			err = watch_picture(w, eye, &picture, captured_ns, fault);
	}
	image_free(&picture);
	sky_eye_destroy(eye);
	live_close(live);
	return err;
}

/* A camera that was there once is waited for. */
static bool watch_waits(const struct watch *w, int err)
{
	return w->last_ns && !watch_ends && (err == -ENODEV || err == -ETIMEDOUT);
}

static int watch_all(struct watch *w, struct fault *fault)
{
	bool lost = false;
	int err;

	for (;;) {
		const double before_s = w->seen_s;

		err = watch_camera(w, fault);
		if (!watch_waits(w, err))
			break;
		if (!lost || w->seen_s > before_s)
			log_warning("%s: waiting", fault->text);
		lost = true;
		sleep(RETRY_S);
	}
	if (!err && !w->last_ns)
		return fault_say(fault, -EINTR, "ended before the first picture");
	watch_finish_moment(w);
	/* What was seen is kept, whatever ended the watch. */
	if (w->last_ns) {
		struct fault why = {.text = ""};
		const int saved = watch_save(w, &why);

		if (!err && saved)
			err = fault_say(fault, saved, "%s", why.text);
	}
	return watch_ends && (err == -ENODEV || err == -ETIMEDOUT) ? 0 : err;
}

static int watch_work(struct watch *w, struct fault *fault)
{
	const struct sigaction end = {.sa_handler = watch_end};
	int err = output_check(&w->output, 1, &w->config, 1, fault);

	if (!err)
		err = sky_need_create(&w->need, w->frequency, fault);
	if (!err && w->need.level[0].count > w->most)
		err = fault_say(fault, -E2BIG,
				"a dome of frequency %d alone has %d lights, more than %d",
				w->frequency, w->need.level[0].count, w->most);
	if (err)
		return err;
	w->sum = calloc((size_t)sky_need_pieces(&w->need)->count, sizeof(*w->sum));
	if (!w->sum)
		return fault_say(fault, -ENOMEM, "not enough memory for the sky");
	sigaction(SIGINT, &end, NULL);
	sigaction(SIGTERM, &end, NULL);
	return watch_all(w, fault);
}

/* ---- the command ---- */

/* Reads a time such as 24h, 90min or 30s. */
static int watch_read_time(void *field, const char *option, const char *given, struct fault *fault)
{
	static const struct {
		const char *name;
		double seconds;
	} units[] = {{"h", 3600}, {"min", 60}, {"s", 1}};
	double *seconds = field;
	const char *text = given + strspn(given, "+-.0123456789");
	char number[32];

	snprintf(number, sizeof(number), "%.*s", (int)(text - given), given);
	for (size_t k = 0; k < sizeof(units) / sizeof(*units); k++)
		if (strcmp(text, units[k].name) == 0 && !number_of(number, seconds) &&
		    *seconds > 0) {
			*seconds *= units[k].seconds;
			return 0;
		}
	return fault_say(fault, -EINVAL,
			 "%s: is \"%s\", expected a time with its unit, such as 24h, 90min or 30s",
			 option, given);
}

#define AT(field) .place = offsetof(struct watch, field)

static const struct option_row options[] = {
	{"live", OPTION_TEXT, AT(config)},
	{"watch", OPTION_OTHER, AT(watch_s), .take = watch_read_time},
	{"frequency", OPTION_INT, AT(frequency), .min = 1, .max = DOME_FREQUENCY_MAX / 2},
	{"most", OPTION_INT, AT(most), .min = 1, .max = DOME_LIGHTS_MAX},
	{"output", OPTION_TEXT, AT(output)},
	{.name = NULL},
};

static int watch_run(const struct command *command, int argc, char **argv)
{
	struct watch w = {.frequency = 9, .most = 1000, .watch_s = WATCH_S};
	struct fault fault = {.text = ""};
	const int status = command_read(command, argc, argv, options, &w);
	int err;

	if (status != COMMAND_GOES_ON)
		return status;
	if (!w.config)
		return command_wrong(command, "--live is missing");
	if (optind != argc)
		return command_wrong(command, "unexpected \"%s\"", argv[optind]);
	if (!w.output)
		return command_wrong(command, "-o FINE is missing");
	err = watch_work(&w, &fault);
	if (err)
		log_error("%s", fault.text);
	free(w.sum);
	sky_need_free(&w.need);
	return err ? EXIT_FAILURE : EXIT_SUCCESS;
}

const struct command watch_command = {
	.name = "sky",
	.usage = "--live KIOSK.conf -o FINE [options]",
	.summary = "watch the sky for lamps and the sun: where lights should be finer",
	.help = "Watches the fisheye of a kiosk's configuration, with the lens and light files that it names.\n"
		"Wherever light is strong and small at any time, what is over-exposed included, FINE gets a part.\n"
		"The kiosk must not run meanwhile: it holds the camera.\n\n"
		"  --watch TIME    with a unit, such as 24h (default), 90min or 30s; Ctrl-C ends it, too\n"
		"  --frequency F   of the dome elsewhere, 1 to 36; 9\n"
		"  --most N        lights in all; 1000\n"
		"  -o FINE         the list of parts, for \"fine\" in [dome] and for --fine of inlay-bake;\n"
		"                  written anew every 10 minutes, always whole\n",
	.run = watch_run,
};
