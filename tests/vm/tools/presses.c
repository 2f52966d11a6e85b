/* SPDX-License-Identifier: MIT */
/*
 * Prints the actions that come from buttons, one a line, as they come.
 *
 *     presses DRIVER SECONDS [option=value]...
 *
 * Says "ready" when the buttons are open. Exit 1 with "error" when they do not open or end.
 */
#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/drivers.h"
#include "hal/base/clock.h"
#include "hal/device/buttons.h"
#include "tests/vm/tools/driver_option.h"

static const struct buttons_ops *find_driver(const char *name)
{
	for (int i = 0; buttons_drivers[i]; i++)
		if (!strcmp(buttons_drivers[i]->name, name))
			return buttons_drivers[i];
	fprintf(stderr, "presses: the driver %s is not in this build\n", name);
	exit(1);
}

static int print_presses(struct buttons *buttons, int64_t until_ns, struct fault *fault)
{
	int64_t left_ns;

	while ((left_ns = until_ns - clock_now_ns()) > 0) {
		struct pollfd p = {.fd = buttons_descriptor(buttons), .events = POLLIN};
		struct button_press press;
		int err;

		poll(&p, 1, (int)(left_ns / 1000000) + 1);
		while (!(err = buttons_read(buttons, &press, fault)))
			printf("%s\n", action_names[press.action]);
		if (err != -EAGAIN)
			return err;
	}
	return 0;
}

int main(int argc, char **argv)
{
	struct buttons buttons = {0};
	struct fault fault = {""};

	if (argc < 3) {
		fprintf(stderr, "usage: presses DRIVER SECONDS [option=value]...\n");
		return 2;
	}
	setvbuf(stdout, NULL, _IOLBF, 0); /* a test waits for single lines */
	const struct buttons_ops *driver = find_driver(argv[1]);
	void *options = calloc(1, driver->options_size + 1);
	ini_defaults(driver->keys, options);
	for (int i = 3; i < argc; i++)
		if (driver_option_set(driver->name, driver->keys, options, argv[i]))
			return 2;

	int err = buttons_open(&buttons, driver, options, &fault);
	if (!err) {
		printf("ready\n");
		err = print_presses(&buttons, clock_now_ns() + atoi(argv[2]) * 1000000000LL,
				    &fault);
	}
	if (err)
		printf("error %s\n", fault.text);
	buttons_close(&buttons);
	free(options);
	return err ? 1 : 0;
}
