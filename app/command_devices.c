/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#include "app/devices_sample.h"
#include "app/settings.h"
#include "drivers/drivers.h"
#include "hal/base/json.h"
#include "hal/base/log.h"

struct devices_options {
	bool json, sample;
};

/* Where the listing goes, and its state. */
struct devices_listing {
	bool is_json;
	struct json json;	       /* what has been written, if it is JSON */
	struct devices_sample *sample; /* NULL: the listing is printed */
	const char *driver;
	int found, failed;
};

#define AT(field) .place = offsetof(struct devices_options, field)

static const struct option_row rows[] = {
	{"json", OPTION_FLAG, AT(json), .help = "for programs"},
	{"sample", OPTION_FLAG, AT(sample),
	 .help = "write a configuration for what is plugged in instead"},
	{.name = NULL}};

static void print_item(struct devices_listing *l, const char *device, const char *name,
		       const char *bus, char (*lines)[160], int line_count)
{
	struct json *json = &l->json;

	l->found++;
	if (!l->is_json) {
		printf("  %s: %s (%s)%s%s\n", l->driver, device, name, *bus ? " at " : "", bus);
		for (int i = 0; i < line_count; i++)
			printf("      %s\n", lines[i]);
		return;
	}
	json_object(json, NULL);
	json_text(json, "driver", l->driver);
	json_text(json, "device", device);
	json_text(json, "name", name);
	json_text(json, "bus", bus);
	json_array(json, "lines");
	for (int i = 0; i < line_count; i++)
		json_text(json, NULL, lines[i]);
	json_end(json);
	json_end(json);
}

static void found_camera(void *context, const struct camera_listing *c)
{
	const struct devices_listing *l = context;

	if (l->sample)
		sample_add_camera(l->sample, l->driver, c);
	else
		print_item(context, c->device, c->name, c->bus, c->lines, c->line_count);
}

static void found_display(void *context, const struct display_listing *d)
{
	const struct devices_listing *l = context;

	if (l->sample)
		sample_add_screen(l->sample, l->driver, d);
	else
		print_item(context, d->device, d->name, "", d->lines, d->line_count);
}

static void found_line(void *context, const char *line)
{
	struct devices_listing *l = context;

	if (l->sample) {
		sample_add_buttons(l->sample, l->driver, line);
		return;
	}
	l->found++;
	if (!l->is_json) {
		printf("  %s: %s\n", l->driver, line);
		return;
	}
	json_object(&l->json, NULL);
	json_text(&l->json, "driver", l->driver);
	json_text(&l->json, "line", line);
	json_end(&l->json);
}

static void begin_class(struct devices_listing *l, const char *title)
{
	l->found = 0;
	if (l->sample)
		return;
	if (l->is_json)
		json_array(&l->json, title);
	else
		printf("%s\n", title);
}

static void end_class(struct devices_listing *l)
{
	if (l->sample)
		return;
	if (l->is_json)
		json_end(&l->json);
	else if (!l->found)
		puts("  none found");
}

/* Reports a driver that cannot list devices; the others go on. */
static void note_failure(struct devices_listing *l, int count)
{
	if (count >= 0)
		return;
	log_warning("devices: driver %s cannot list: error %d", l->driver, -count);
	l->failed++;
}

static void list_all(struct devices_listing *l)
{
	begin_class(l, "cameras");
	for (int i = 0; camera_drivers[i]; i++) {
		l->driver = camera_drivers[i]->name;
		if (camera_drivers[i]->list)
			note_failure(l, camera_drivers[i]->list(found_camera, l));
	}
	end_class(l);
	begin_class(l, "screens");
	for (int i = 0; display_drivers[i]; i++) {
		l->driver = display_drivers[i]->name;
		if (display_drivers[i]->list)
			note_failure(l, display_drivers[i]->list(found_display, l));
	}
	end_class(l);
	begin_class(l, "buttons");
	for (int i = 0; buttons_drivers[i]; i++) {
		l->driver = buttons_drivers[i]->name;
		if (buttons_drivers[i]->list)
			note_failure(l, buttons_drivers[i]->list(found_line, l));
	}
	end_class(l);
}

static void list_drivers(struct devices_listing *l)
{
	if (l->is_json) {
		json_end(&l->json);
		return;
	}
	puts("drivers");
	for (int i = 0; camera_drivers[i]; i++)
		printf("  camera   %-9s %s\n", camera_drivers[i]->name,
		       camera_drivers[i]->description);
	for (int i = 0; display_drivers[i]; i++)
		printf("  screen   %-9s %s\n", display_drivers[i]->name,
		       display_drivers[i]->description);
	for (int i = 0; buttons_drivers[i]; i++)
		printf("  buttons  %-9s %s\n", buttons_drivers[i]->name,
		       buttons_drivers[i]->description);
}

static int write_sample(void)
{
	struct devices_listing listing = {.sample = sample_create()};

	if (!listing.sample) {
		log_error("devices: not enough memory");
		return EXIT_FAILURE;
	}
	list_all(&listing);
	sample_write(listing.sample, stdout);
	if (sample_refused(listing.sample))
		log_warning(
			"devices: some devices are not for this user and are left out: inlay devices names them, as root it sees them");
	sample_destroy(listing.sample);
	return listing.failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

static int devices_run(const struct command *command, int argc, char **argv)
{
	struct devices_options options = {.json = false};
	struct devices_listing listing = {.sample = NULL};
	int code = command_read_all(command, argc, argv, rows, &options);

	if (code != COMMAND_GOES_ON)
		return code;
	if (options.sample && options.json)
		return command_wrong(command, "--json and --sample, expected one of them");
	if (options.sample)
		return write_sample();
	listing.is_json = options.json;
	if (options.json)
		json_begin_line(&listing.json, stdout);
	list_all(&listing);
	list_drivers(&listing);
	return listing.failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

const struct command command_devices = {
	.name = "devices",
	.usage = "[--json | --sample]",
	.summary = "list the cameras, screens and buttons that there are",
	.help = "\nWhat stands first after a driver's name is what the configuration calls its device:\n"
		"    cameras   driver = v4l2, device = /dev/video0; better a link, the name or the bus,\n"
		"              which stay when numbers change\n"
		"    screens   driver = kms, device = /dev/dri/card0, kms.connector = HDMI-A-1\n"
		"    buttons   driver = gpio, gpio.chip = gpiochip0 or its label\n"
		"Formats, sizes and controls are written as they are listed. A first configuration\n"
		"comes from inlay devices --sample > kiosk.conf.\n",
	.run = devices_run,
};
