/* SPDX-License-Identifier: MIT */
#include "app/driver_list.h"

#include <pthread.h>

#include "drivers/drivers.h"

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
