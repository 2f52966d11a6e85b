/* SPDX-License-Identifier: MIT */
/*
 * Shows a picture on a real screen through a driver and says what happened, one "name value" a
 * line, so that a shell test can check it.
 *
 *     show DRIVER PICTURE.png FRAMES [patient] [device=D] [width=W] [height=H] [rate=HZ]
 *          [connector=C] and the driver's other options
 *
 * The picture stands in the middle of a black screen. After FRAMES flips it says "ready 1", keeps
 * the screen until SIGTERM or SIGINT, and gives it back. Exit 1 with "error" when that fails; with
 * "patient" a screen that may return is waited for ("waiting", "lost"), and shown on again.
 * "hidden" and "exposed" tell of the console being switched away and back.
 */
#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/drivers.h"
#include "hal/device/display.h"
#include "hal/image/image.h"
#include "tests/vm/tools/driver_option.h"

struct flips {
	int shown, backwards, out_of_order;
	int64_t first_ns, last_ns, last_token;
};

static volatile sig_atomic_t asked_to_stop;

static void show_stop(int signal_number)
{
	(void)signal_number;
	asked_to_stop = 1;
}

static void test_show_draw(const struct display_buffer *buffer, const struct image *image)
{
	const int left = (buffer->width - image->width) / 2;
	const int top = (buffer->height - image->height) / 2;

	for (int y = 0; y < buffer->height; y++) {
		uint8_t *to = buffer->pixels + (size_t)y * buffer->stride;
		for (int x = 0; x < buffer->width; x++, to += 4) {
			const int u = x - left, v = y - top;
			const bool in = u >= 0 && v >= 0 && u < image->width && v < image->height;
			const uint8_t *from = in ? image->u8 + ((size_t)v * image->width + u) * 3
						 : NULL;
			to[0] = in ? from[2] : 0;
			to[1] = in ? from[1] : 0;
			to[2] = in ? from[0] : 0;
			to[3] = 255;
		}
	}
}

static void note(struct flips *flips, const struct display_event *event)
{
	if (flips->shown == 0)
		flips->first_ns = event->time_ns;
	else if (event->time_ns <= flips->last_ns)
		flips->backwards++;
	if (event->token != flips->last_token + 1)
		flips->out_of_order++;
	flips->last_ns = event->time_ns;
	flips->last_token = event->token;
	flips->shown++;
}

/* As in a kiosk: draws, and takes in events. */
struct show_state {
	struct display display;
	const struct image *image;
	int frames; /* frames to show before "ready" */
	int64_t token;
	struct flips flips;
	bool hidden, ready;
};

static int draw_one(struct show_state *show, struct fault *fault)
{
	struct display_buffer buffer;
	int err = display_acquire(&show->display, &buffer);

	if (err)
		return err == -EAGAIN ? 0 : fault_say(fault, err, "acquire: %s", strerror(-err));
	test_show_draw(&buffer, show->image);
	return display_submit(&show->display, &buffer, ++show->token, fault);
}

static int take_events(struct show_state *show, struct fault *fault)
{
	struct display_event event;
	int err;

	do {
		err = display_dispatch(&show->display, &event, fault);
		if (!err && event.kind == DISPLAY_SHOWN)
			note(&show->flips, &event);
		if (!err && event.kind == DISPLAY_EXPOSED) {
			printf("exposed 1\n");
			err = draw_one(show, fault);
		}
	} while (!err && event.kind != DISPLAY_NOTHING);
	if (show->hidden != show->display.hidden)
		printf("hidden %d\n", show->hidden = show->display.hidden);
	return err;
}

static void say_ready(struct show_state *show)
{
	const struct flips *flips = &show->flips;

	printf("shown %d\nbackwards %d\nout_of_order %d\n", flips->shown, flips->backwards,
	       flips->out_of_order);
	if (flips->shown > 1)
		printf("measured_rate %.2f\n",
		       1e9 * (flips->shown - 1) / (double)(flips->last_ns - flips->first_ns));
	printf("ready 1\n");
	show->ready = true;
}

/* Shows until a signal (0) or until the screen fails. Signals arrive only while waiting. */
static int show_run(struct show_state *show, const sigset_t *waiting, struct fault *fault)
{
	const struct timespec patience = {.tv_sec = 5};
	int err = 0;

	while (!err && !asked_to_stop) {
		struct pollfd p = {.fd = display_descriptor(&show->display), .events = POLLIN};
		const bool drawing = show->flips.shown < show->frames;
		int woken;

		if (!drawing && !show->ready)
			say_ready(show);
		if (show->token < show->frames)
			err = draw_one(show, fault);
		if (err)
			return err;
		woken = ppoll(&p, 1, drawing && !show->hidden ? &patience : NULL, waiting);
		if (woken == 0)
			return fault_say(fault, -ETIMEDOUT, "no flip for 5 s");
		if (woken > 0)
			err = take_events(show, fault);
	}
	return err;
}

/* Opens the display; with patient, again and again as long as that may help. */
static int open_patiently(struct show_state *show, const struct display_ops *driver,
			  const struct display_settings *settings, void *options, bool patient,
			  const sigset_t *waiting, struct fault *fault)
{
	const struct timespec moment = {.tv_nsec = 100000000};
	enum display_situation said = DISPLAY_FINE;
	int err;

	while ((err = display_open(&show->display, driver, settings, options, fault)) && patient &&
	       !asked_to_stop && display_may_return(show->display.situation)) {
		if (said != show->display.situation)
			printf("waiting %s: %s\n", display_situation_names[show->display.situation],
			       fault->text);
		said = show->display.situation;
		ppoll(NULL, 0, &moment, waiting);
	}
	if (!err) {
		printf("mode %dx%d\nrate %g\n", show->display.width, show->display.height,
		       show->display.rate_hz);
		show->hidden = false;
		show->ready = false;
		show->flips = (struct flips){0};
		show->token = 0;
	}
	return err;
}

static const struct display_ops *find_driver(const char *name)
{
	for (int i = 0; display_drivers[i]; i++)
		if (!strcmp(display_drivers[i]->name, name))
			return display_drivers[i];
	fprintf(stderr, "show: the driver %s is not in this build\n", name);
	exit(1);
}

static int parse(int argc, char **argv, struct display_settings *settings,
		 const struct display_ops *driver, void *options, bool *patient)
{
	for (int i = 4; i < argc; i++) {
		const char *option = argv[i];
		if (!strncmp(option, "device=", 7))
			snprintf(settings->device, sizeof(settings->device), "%s", option + 7);
		else if (!strncmp(option, "width=", 6))
			settings->width = atoi(option + 6);
		else if (!strncmp(option, "height=", 7))
			settings->height = atoi(option + 7);
		else if (!strncmp(option, "rate=", 5))
			settings->rate_hz = atof(option + 5);
		else if (!strcmp(option, "patient"))
			*patient = true;
		else if (driver_option_set(driver->name, driver->keys, options, option))
			return -EINVAL;
	}
	return 0;
}

int main(int argc, char **argv)
{
	struct display_settings settings = {0};
	struct image image = {0};
	struct show_state show = {.image = &image};
	struct fault fault = {""};
	sigset_t stopping, waiting;
	bool patient = false;

	if (argc < 4) {
		fprintf(stderr,
			"usage: show DRIVER PICTURE.png FRAMES [patient] [name=value]...\n");
		return 2;
	}
	setvbuf(stdout, NULL, _IOLBF, 0); /* a test waits for single lines */
	const struct display_ops *driver = find_driver(argv[1]);
	void *options = driver->options_size ? calloc(1, driver->options_size) : NULL;
	if (driver->keys)
		ini_defaults(driver->keys, options);
	if (parse(argc, argv, &settings, driver, options, &patient))
		return 2;

	/* blocked except while waiting, so that no signal is missed */
	sigemptyset(&stopping);
	sigaddset(&stopping, SIGTERM);
	sigaddset(&stopping, SIGINT);
	sigprocmask(SIG_BLOCK, &stopping, &waiting);
	signal(SIGTERM, show_stop);
	signal(SIGINT, show_stop);

	int err = image_read(argv[2], &image, &fault);
	show.frames = atoi(argv[3]);
	settings.picture_width = image.width;
	settings.picture_height = image.height;
	while (!err && !asked_to_stop) {
		err = open_patiently(&show, driver, &settings, options, patient, &waiting, &fault);
		if (err)
			break;
		err = show_run(&show, &waiting, &fault);
		if (err && patient && display_may_return(show.display.situation)) {
			printf("lost %s: %s\n", display_situation_names[show.display.situation],
			       fault.text);
			err = 0;
		}
		if (err)
			display_close(&show.display, NULL);
		else
			err = display_close(&show.display, &fault);
	}
	if (err && !asked_to_stop)
		printf("error %s\n", fault.text);
	image_free(&image);
	free(options);
	return err ? 1 : 0;
}
