/* SPDX-License-Identifier: MIT */
#include "app/driver_list.h"

#include "drivers/drivers.h"

const struct config_drivers *driver_list(void)
{
	static struct config_driver_room room;
	static struct config_drivers drivers;

	drivers = config_drivers_of(&room, camera_drivers, display_drivers, buttons_drivers);
	return &drivers;
}
