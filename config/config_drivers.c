/* SPDX-License-Identifier: MIT */
/* Drivers as the configuration wants to know them: names and tables of keys. */
#include "config/config.h"

struct config_drivers config_drivers_of(struct config_driver_room *room,
					const struct camera_ops *const *cameras,
					const struct display_ops *const *displays,
					const struct buttons_ops *const *buttons)
{
	struct config_drivers drivers;

	/* Zeroed: each list ends where nothing was written. */
	*room = (struct config_driver_room){.list = {{{.name = NULL}}}};
	for (int kind = 0; kind < CONFIG_CLASS_COUNT; kind++)
		drivers.list[kind] = room->list[kind];
	for (int i = 0; i <= CONFIG_DRIVERS_MAX && cameras[i]; i++)
		room->list[CONFIG_CAMERA][i] = (struct config_driver){
			cameras[i]->name, cameras[i]->keys, cameras[i]->options_size};
	for (int i = 0; i <= CONFIG_DRIVERS_MAX && displays[i]; i++)
		room->list[CONFIG_DISPLAY][i] = (struct config_driver){
			displays[i]->name, displays[i]->keys, displays[i]->options_size};
	for (int i = 0; i <= CONFIG_DRIVERS_MAX && buttons[i]; i++)
		room->list[CONFIG_BUTTONS][i] = (struct config_driver){
			buttons[i]->name, buttons[i]->keys, buttons[i]->options_size};
	return drivers;
}
