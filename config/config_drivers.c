/* SPDX-License-Identifier: MIT */
/* Lists of drivers: their names and tables of keys. */
#include "config/config_drivers.h"

#include <stdio.h>
#include <string.h>

struct config_drivers config_drivers_of(struct config_driver_room *room,
					const struct camera_ops *const *cameras,
					const struct display_ops *const *displays,
					const struct buttons_ops *const *buttons)
{
	struct config_drivers drivers;

	/* All names are NULL, so each list ends behind its last driver. */
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

int config_driver_index(const struct config *config, enum config_class kind, const char *name)
{
	const struct config_driver *drivers = config->drivers.list[kind];

	for (int i = 0; drivers[i].name; i++) {
		if (!strcmp(drivers[i].name, name))
			return i;
	}
	return -1;
}

bool config_next_word(const char **text, char word[CONFIG_NAME_MAX])
{
	size_t length;

	*text += strspn(*text, " \t,");
	length = strcspn(*text, " \t,");
	snprintf(word, CONFIG_NAME_MAX, "%.*s", (int)(length < 60 ? length : 60), *text);
	*text += length;
	return length > 0;
}

int config_buttons_used(const struct config *config, int drivers[CONFIG_DRIVERS_MAX])
{
	const char *text = config->buttons->driver;
	char word[CONFIG_NAME_MAX];
	bool seen[CONFIG_DRIVERS_MAX] = {false};
	int count = 0;

	while (config_next_word(&text, word)) {
		int driver = config_driver_index(config, CONFIG_BUTTONS, word);

		if (driver < 0 || seen[driver])
			continue;
		seen[driver] = true;
		drivers[count++] = driver;
	}
	return count;
}
