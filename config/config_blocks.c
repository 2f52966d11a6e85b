/* SPDX-License-Identifier: MIT */
#include "config/config_parts.h"

#include <errno.h>
#include <stdalign.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static size_t block_aligned(size_t bytes)
{
	size_t step = alignof(max_align_t);

	return (bytes + step - 1) / step * step;
}

int config_block_lay_out(struct config *config, enum config_class kind, size_t section_bytes)
{
	const struct config_driver *drivers = config->drivers.list[kind];
	size_t bytes = block_aligned(section_bytes);
	int i;

	for (i = 0; drivers[i].name; i++) {
		if (i == CONFIG_DRIVERS_MAX)
			return -E2BIG;
		config->option_offset[kind][i] = bytes;
		bytes += block_aligned(drivers[i].options_size);
		snprintf(config->prefix[kind][i], CONFIG_NAME_MAX, "%s.", drivers[i].name);
	}
	config->block_bytes[kind] = bytes;
	return 0;
}

void *config_block_create(const struct config *config, enum config_class kind,
			  const struct ini_key *keys)
{
	char *block = calloc(1, config->block_bytes[kind]);
	const struct config_driver *drivers = config->drivers.list[kind];

	if (!block)
		return NULL;
	ini_defaults(keys, block);
	for (int i = 0; drivers[i].name; i++) {
		if (drivers[i].keys)
			ini_defaults(drivers[i].keys, block + config->option_offset[kind][i]);
	}
	return block;
}

void *config_options(const struct config *config, enum config_class kind, void *block, int driver)
{
	return (char *)block + config->option_offset[kind][driver];
}

struct config_camera *config_camera_named(const struct config *config, const char *name)
{
	for (int i = 0; i < config->camera_count; i++) {
		if (!strcmp(config->cameras[i]->name, name))
			return config->cameras[i];
	}
	return NULL;
}

/* While a frame of depths is read the driver needs two more buffers. */
#define DEPTH_BUFFERS 3

struct camera_settings config_camera_settings(const struct config *config,
					      const struct config_camera *camera)
{
	struct camera_settings settings = camera->settings;

	if (strcmp(config->depth.view.camera, camera->name) != 0)
		return settings;
	settings.format = PIXEL_Z16;
	if (settings.buffers < DEPTH_BUFFERS)
		settings.buffers = DEPTH_BUFFERS;
	return settings;
}

/* ---- lists of drivers ---- */

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
