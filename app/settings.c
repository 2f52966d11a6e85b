/* SPDX-License-Identifier: MIT */
#include "app/settings.h"

#include <errno.h>
#include <pthread.h>
#include <string.h>
#include <unistd.h>

#include "drivers/drivers.h"
#include "hal/base/log.h"

void settings_say(void *context, const char *text)
{
	(void)context;
	log_error("%s", text);
}

const char *settings_file(const struct settings *settings)
{
	if (settings->config_file)
		return settings->config_file;
	return access(SETTINGS_FILE, F_OK) == 0 ? SETTINGS_FILE : NULL;
}

int settings_read(const struct settings *settings, struct config **config,
		  struct ini_report *report)
{
	const char *file = settings_file(settings);
	int err = config_create(config, driver_list()), first = 0;

	if (err) {
		fault_say(&report->first, err, "cannot set up the configuration: %s",
			  strerror(-err));
		return err;
	}
	if (file)
		first = config_read(*config, file, report);
	for (int i = 0; i < settings->set.count; i++) {
		err = config_set(*config, settings->set.text[i], report);
		if (err && !first)
			first = err;
	}
	/* A file that does not exist is a fault like others, and does not hide them. */
	err = config_read_files(*config, report) ? -EINVAL : 0;
	return first ? first : err;
}

static struct config_driver_room room;
static struct config_drivers drivers;

static void fill(void)
{
	drivers = config_drivers_of(&room, camera_drivers, display_drivers, buttons_drivers);
}

/* Filled once: the thread that reads a configuration anew asks while others open devices by it. */
const struct config_drivers *driver_list(void)
{
	static pthread_once_t once = PTHREAD_ONCE_INIT;

	pthread_once(&once, fill);
	return &drivers;
}
