#include "app/driver_list.h"

#include "drivers/drivers.h"

const struct config_drivers *driver_list(void)
{
	/* Zeroed: each list ends where nothing was written. config_create() refuses longer ones. */
	static struct config_driver cameras[CONFIG_DRIVERS_MAX + 1];
	static struct config_driver displays[CONFIG_DRIVERS_MAX + 1];
	static struct config_driver buttons[CONFIG_DRIVERS_MAX + 1];
	static const struct config_drivers drivers = {
		.list = {[CONFIG_CAMERA] = cameras,
			 [CONFIG_DISPLAY] = displays,
			 [CONFIG_BUTTONS] = buttons},
	};

	for (int i = 0; i < CONFIG_DRIVERS_MAX && camera_drivers[i]; i++)
		cameras[i] = (struct config_driver){camera_drivers[i]->name,
						    camera_drivers[i]->keys,
						    camera_drivers[i]->options_size};
	for (int i = 0; i < CONFIG_DRIVERS_MAX && display_drivers[i]; i++)
		displays[i] = (struct config_driver){display_drivers[i]->name,
						     display_drivers[i]->keys,
						     display_drivers[i]->options_size};
	for (int i = 0; i < CONFIG_DRIVERS_MAX && buttons_drivers[i]; i++)
		buttons[i] = (struct config_driver){buttons_drivers[i]->name,
						    buttons_drivers[i]->keys,
						    buttons_drivers[i]->options_size};
	return &drivers;
}
