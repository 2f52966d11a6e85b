/* SPDX-License-Identifier: MIT */
/*
 * A keyboard that types what it is told, through the kernel's uinput: unplugged when its input
 * ends.
 *
 *     keys NAME <COMMANDS         down KEY | up KEY | press KEY | flood COUNT KEY, one a line
 *     keys NAME touch <COMMANDS   a touch screen that has no key: tap
 *
 * KEY is a name as in the configuration. Held keys repeat, as the kernel does it for any keyboard.
 * Says "ready /dev/input/eventN" when it is plugged in.
 */
#include <dirent.h>
#include <fcntl.h>
#include <linux/uinput.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "drivers/keyboard/keyboard.h"

static int device;

static void die(const char *what)
{
	perror(what);
	exit(1);
}

static void emit(int type, int code, int value)
{
	const struct input_event event = {
		.type = (unsigned short)type,
		.code = (unsigned short)code,
		.value = value,
	};

	if (write(device, &event, sizeof(event)) != sizeof(event))
		die("uinput");
}

static void keys_turn(int code, int value)
{
	emit(EV_KEY, code, value);
	emit(EV_SYN, SYN_REPORT, 0);
}

static int code_of(const char *name)
{
	const int code = keymap_code(name);

	if (code < 0) {
		fprintf(stderr, "keys: unknown key %s\n", name);
		exit(2);
	}
	return code;
}

static void tap(void)
{
	static int finger;

	emit(EV_ABS, ABS_MT_TRACKING_ID, ++finger);
	emit(EV_SYN, SYN_REPORT, 0);
	emit(EV_ABS, ABS_MT_TRACKING_ID, -1);
	emit(EV_SYN, SYN_REPORT, 0);
}

static void add_axes(void)
{
	static const unsigned short axes[] = {ABS_MT_SLOT, ABS_MT_TRACKING_ID, ABS_MT_POSITION_X,
					      ABS_MT_POSITION_Y};

	if (ioctl(device, UI_SET_EVBIT, EV_ABS))
		die("event types");
	for (size_t i = 0; i < sizeof(axes) / sizeof(axes[0]); i++) {
		struct uinput_abs_setup axis = {
			.code = axes[i], .absinfo = {.maximum = axes[i] == ABS_MT_SLOT ? 4 : 4095}};

		if (ioctl(device, UI_SET_ABSBIT, axes[i]) || ioctl(device, UI_ABS_SETUP, &axis))
			die("axes");
	}
}

static void plug_in(const char *name, bool touch)
{
	struct uinput_setup setup = {.id = {.bustype = BUS_USB}};

	device = open("/dev/uinput", O_WRONLY);
	if (device < 0)
		die("/dev/uinput");
	snprintf(setup.name, sizeof(setup.name), "%s", name);
	if (touch)
		add_axes();
	else if (ioctl(device, UI_SET_EVBIT, EV_KEY) || ioctl(device, UI_SET_EVBIT, EV_REP))
		die("event types");
	for (int code = 1; code < 128 && !touch; code++)
		if (ioctl(device, UI_SET_KEYBIT, code))
			die("keys");
	if (ioctl(device, UI_DEV_SETUP, &setup) || ioctl(device, UI_DEV_CREATE))
		die("device");
}

/* Prints the device node, found by the name that the kernel gave. */
static void say_node(void)
{
	char name[64] = "", path[128];
	struct dirent *entry;
	DIR *folder;

	if (ioctl(device, UI_GET_SYSNAME(sizeof(name) - 1), name) < 0)
		die("name");
	snprintf(path, sizeof(path), "/sys/devices/virtual/input/%s", name);
	folder = opendir(path);
	if (!folder)
		die(path);
	while ((entry = readdir(folder)))
		if (!strncmp(entry->d_name, "event", 5))
			printf("ready /dev/input/%s\n", entry->d_name);
	closedir(folder);
	fflush(stdout);
}

int main(int argc, char **argv)
{
	char line[128], key[64];
	int count;

	if (argc != 2 && (argc != 3 || strcmp(argv[2], "touch") != 0)) {
		fprintf(stderr, "usage: keys NAME [touch] <COMMANDS\n");
		return 2;
	}
	plug_in(argv[1], argc == 3);
	say_node();
	while (fgets(line, sizeof(line), stdin) && strcmp(line, "unplug\n")) {
		if (strcmp(line, "tap\n") == 0) {
			tap();
		} else if (sscanf(line, "down %63s", key) == 1) {
			keys_turn(code_of(key), 1);
		} else if (sscanf(line, "up %63s", key) == 1) {
			keys_turn(code_of(key), 0);
		} else if (sscanf(line, "press %63s", key) == 1) {
			keys_turn(code_of(key), 1);
			keys_turn(code_of(key), 0);
		} else if (sscanf(line, "flood %d %63s", &count, key) == 2) {
			for (; count > 0; count--) {
				keys_turn(code_of(key), 1);
				keys_turn(code_of(key), 0);
			}
		} else {
			fprintf(stderr, "keys: what is %s", line);
			return 2;
		}
	}
	return 0; /* the kernel removes the device when the program ends */
}
