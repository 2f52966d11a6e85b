/*
 * Shows a picture on a real screen through a driver and says what happened, one "name value" a
 * line, so that a shell test can check it.
 *
 *     show DRIVER PICTURE.png FRAMES [device=D] [width=W] [height=H] [rate=HZ] [connector=C]
 *
 * The picture stands in the middle of a black screen. After FRAMES flips it says "ready 1", keeps
 * the screen until SIGTERM or SIGINT, and gives it back. Exit 1 with "error" when that fails.
 */
#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/drivers.h"
#include "hal/display.h"
#include "hal/image/image.h"
#include "tests/vm/driver_option.h"

struct flips {
	int shown, backwards, out_of_order;
	int64_t first_ns, last_ns, last_token;
};

static volatile sig_atomic_t asked_to_stop;

static void stop(int signal_number)
{
	(void)signal_number;
	asked_to_stop = 1;
}

static void draw(const struct display_buffer *buffer, const struct image *image)
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

static int run(struct display *display, const struct image *image, int frames, struct flips *flips,
	       struct fault *fault)
{
	int64_t token = 0;

	while (flips->shown < frames && !asked_to_stop) {
		struct display_buffer buffer;
		struct display_event event;
		int err = 0;

		while (token < frames && !display_acquire(display, &buffer)) {
			draw(&buffer, image);
			err = display_submit(display, &buffer, ++token, fault);
			if (err)
				return err;
		}
		struct pollfd p = {.fd = display_descriptor(display), .events = POLLIN};
		if (poll(&p, 1, 5000) == 0)
			return fault_say(fault, -ETIMEDOUT, "no flip for 5 s");
		do {
			err = display_dispatch(display, &event, fault);
			if (err)
				return err;
			if (event.kind == DISPLAY_SHOWN)
				note(flips, &event);
		} while (event.kind != DISPLAY_NOTHING);
	}
	return 0;
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
		 const struct display_ops *driver, void *options)
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
		else if (driver_option_set(driver->name, driver->keys, options, option))
			return -EINVAL;
	}
	return 0;
}

int main(int argc, char **argv)
{
	struct display_settings settings = {0};
	struct display display = {0};
	struct image image = {0};
	struct flips flips = {0};
	struct fault fault = {""};
	sigset_t stopping, before;

	if (argc < 4) {
		fprintf(stderr, "usage: show DRIVER PICTURE.png FRAMES [name=value]...\n");
		return 2;
	}
	setvbuf(stdout, NULL, _IOLBF, 0); /* a test waits for single lines */
	const struct display_ops *driver = find_driver(argv[1]);
	void *options = driver->options_size ? calloc(1, driver->options_size) : NULL;
	if (driver->keys)
		ini_defaults(driver->keys, options);
	if (parse(argc, argv, &settings, driver, options))
		return 2;

	/* Blocked but while waiting below, so that no signal is missed. */
	sigemptyset(&stopping);
	sigaddset(&stopping, SIGTERM);
	sigaddset(&stopping, SIGINT);
	sigprocmask(SIG_BLOCK, &stopping, &before);
	signal(SIGTERM, stop);
	signal(SIGINT, stop);

	int err = image_read(argv[2], &image, &fault);
	if (!err) {
		settings.picture_width = image.width;
		settings.picture_height = image.height;
		err = display_open(&display, driver, &settings, options, &fault);
	}
	if (!err) {
		printf("mode %dx%d\nrate %g\n", display.width, display.height, display.rate_hz);
		err = run(&display, &image, atoi(argv[3]), &flips, &fault);
		printf("shown %d\nbackwards %d\nout_of_order %d\n", flips.shown, flips.backwards,
		       flips.out_of_order);
		if (flips.shown > 1)
			printf("measured_rate %.2f\n",
			       1e9 * (flips.shown - 1) / (double)(flips.last_ns - flips.first_ns));
	}
	if (!err) {
		printf("ready 1\n");
		while (!asked_to_stop)
			sigsuspend(&before);
		err = display_close(&display, &fault);
	}
	if (err)
		printf("error %s\n", fault.text);
	display_close(&display, NULL);
	image_free(&image);
	free(options);
	return err ? 1 : 0;
}
