/* SPDX-License-Identifier: MIT */
#include "config/config.h"

#include <errno.h>
#include <stdalign.h>
#include <stdlib.h>
#include <string.h>

#include "config/config_keys.h"
#include "hal/lights/sampler.h"

/* What each class of driver belongs to in the file. */
static const struct {
	const char *section;
	bool named;
	size_t bytes; /* of the section's own struct */
	const struct ini_key *keys;
	void *(*place)(void *root, const char *instance);
} classes[CONFIG_CLASS_COUNT] = {
	[CONFIG_CAMERA] = {"camera", true, sizeof(struct config_camera), config_camera_keys,
			   config_place_camera},
	[CONFIG_DISPLAY] = {"screen", false, sizeof(struct config_screen), config_screen_keys,
			    config_place_screen},
	[CONFIG_BUTTONS] = {"buttons", false, sizeof(struct config_buttons), config_buttons_keys,
			    config_place_buttons},
};

static size_t aligned(size_t bytes)
{
	size_t step = alignof(max_align_t);

	return (bytes + step - 1) / step * step;
}

/* ---- blocks: a section's struct and the options of its drivers behind it ---- */

static void *block_create(const struct config *config, enum config_class kind)
{
	char *block = calloc(1, config->block_bytes[kind]);
	const struct config_driver *drivers = config->drivers.list[kind];

	if (!block)
		return NULL;
	ini_defaults(classes[kind].keys, block);
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

void *config_place_camera(void *root, const char *instance)
{
	struct config *config = root;
	struct config_camera *camera = config_camera_named(config, instance);

	if (camera || config->camera_count == CONFIG_CAMERAS_MAX)
		return camera;
	camera = block_create(config, CONFIG_CAMERA);
	if (!camera)
		return NULL;
	snprintf(camera->name, sizeof(camera->name), "%s", instance);
	config->cameras[config->camera_count++] = camera;
	return camera;
}

void *config_place_screen(void *root, const char *instance)
{
	(void)instance;
	return ((struct config *)root)->screen;
}

void *config_place_buttons(void *root, const char *instance)
{
	(void)instance;
	return ((struct config *)root)->buttons;
}

/* ---- making ---- */

/* Where the options of each driver start, and how their keys are prefixed. */
static int lay_out(struct config *config, enum config_class kind)
{
	const struct config_driver *drivers = config->drivers.list[kind];
	size_t bytes = aligned(classes[kind].bytes);
	int i;

	for (i = 0; drivers[i].name; i++) {
		if (i == CONFIG_DRIVERS_MAX)
			return -E2BIG;
		config->option_offset[kind][i] = bytes;
		bytes += aligned(drivers[i].options_size);
		snprintf(config->prefix[kind][i], CONFIG_NAME_MAX, "%s.", drivers[i].name);
	}
	config->block_bytes[kind] = bytes;
	return 0;
}

static int driver_table_count(const struct config *config)
{
	int count = 0;

	for (int kind = 0; kind < CONFIG_CLASS_COUNT; kind++) {
		for (int i = 0; config->drivers.list[kind][i].name; i++)
			count += config->drivers.list[kind][i].keys != NULL;
	}
	return count;
}

/* The fixed tables and one more for each driver that has keys. */
static int tables_create(struct config *config)
{
	size_t count = config_table_count;

	config->tables = calloc(count + (size_t)driver_table_count(config) + 1,
				sizeof(*config->tables));
	if (!config->tables)
		return -ENOMEM;
	memcpy(config->tables, config_tables, count * sizeof(*config_tables));
	for (int kind = 0; kind < CONFIG_CLASS_COUNT; kind++) {
		const struct config_driver *drivers = config->drivers.list[kind];

		for (int i = 0; drivers[i].name; i++) {
			if (!drivers[i].keys)
				continue;
			config->tables[count++] = (struct ini_table){
				.section = classes[kind].section,
				.named = classes[kind].named,
				.prefix = config->prefix[kind][i],
				.keys = drivers[i].keys,
				.place = classes[kind].place,
				.part = config->option_offset[kind][i],
			};
		}
	}
	return 0;
}

/* Named sections have no struct until the file names them. */
static void defaults_fill(struct config *config)
{
	for (const struct ini_table *t = config_tables; t->section; t++) {
		if (!t->named)
			ini_defaults(t->keys, (char *)t->place(config, NULL) + t->part);
	}
}

int config_create(struct config **out, const struct config_drivers *drivers)
{
	struct config *config = calloc(1, sizeof(*config));
	int err;

	if (!config)
		return -ENOMEM;
	config->drivers = *drivers;
	snprintf(config->name, sizeof(config->name), "configuration");
	for (int kind = 0; kind < CONFIG_CLASS_COUNT; kind++) {
		err = lay_out(config, kind);
		if (err)
			goto destroy;
	}
	err = tables_create(config);
	if (err)
		goto destroy;
	config->screen = block_create(config, CONFIG_DISPLAY);
	config->buttons = block_create(config, CONFIG_BUTTONS);
	if (!config->screen || !config->buttons) {
		err = -ENOMEM;
		goto destroy;
	}
	defaults_fill(config);
	response_begin(&config->fisheye.measured);
	response_begin(&config->background.measured);
	*out = config;
	return 0;
destroy:
	config_destroy(config);
	return err;
}

void config_destroy(struct config *config)
{
	if (!config)
		return;
	for (int i = 0; i < config->camera_count; i++)
		free(config->cameras[i]);
	free(config->screen);
	free(config->buttons);
	free(config->tables);
	free(config);
}

/* ---- reading ---- */

int config_read(struct config *config, const char *path, struct ini_report *report)
{
	snprintf(config->name, sizeof(config->name), "%s", path);
	return ini_read(path, config->tables, config, report);
}

int config_read_memory(struct config *config, const char *text, size_t bytes, const char *name,
		       struct ini_report *report)
{
	snprintf(config->name, sizeof(config->name), "%s", name);
	return ini_read_memory(text, bytes, name, "", config->tables, config, report);
}

int config_set(struct config *config, const char *assignment, struct ini_report *report)
{
	return ini_set(assignment, config->tables, config, report);
}

/* ---- looking up ---- */

struct transfer_curve config_fisheye_curve(const struct config_fisheye *fisheye)
{
	return response_curve(&fisheye->measured, (enum transfer)fisheye->transfer,
			      fisheye->black_level);
}

struct transfer_curve config_background_curve(const struct config_background *background)
{
	return response_curve(&background->measured, (enum transfer)background->transfer, 0);
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

struct config_camera *config_camera_named(const struct config *config, const char *name)
{
	for (int i = 0; i < config->camera_count; i++) {
		if (!strcmp(config->cameras[i]->name, name))
			return config->cameras[i];
	}
	return NULL;
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

struct view config_view(const struct config_view *view)
{
	struct view turned = view->view;

	turned.hflip ^= view->rotate180;
	turned.vflip ^= view->rotate180;
	return turned;
}

/* ---- printing ---- */

static void print_section(const struct config *config, const char *section, const char *instance,
			  FILE *stream)
{
	fprintf(stream, "[%s%s%s]\n", section, instance ? " " : "", instance ? instance : "");
	for (const struct ini_table *t = config->tables; t->section; t++) {
		if (strcmp(t->section, section) != 0)
			continue;
		for (const struct ini_key *key = t->keys; key->name; key++) {
			char value[INI_PATH_MAX];
			const char *place = t->place((void *)config, instance);

			ini_value_text(key, place + t->part, value, sizeof(value));
			/* After a blank a semicolon would begin a comment. */
			fprintf(stream, "%s%s =%s%s\n", t->prefix ? t->prefix : "", key->name,
				*value && *value != ';' ? " " : "", value);
		}
	}
	fputc('\n', stream);
}

void config_print(const struct config *config, FILE *stream)
{
	const char *last = "";

	for (const struct ini_table *t = config_tables; t->section; t++) {
		if (!strcmp(t->section, last))
			continue;
		last = t->section;
		for (int i = 0; t->named && i < config->camera_count; i++)
			print_section(config, t->section, config->cameras[i]->name, stream);
		if (!t->named)
			print_section(config, t->section, NULL, stream);
	}
}

void config_write_sample(const struct config *config, FILE *stream)
{
	ini_write_sample(stream, config->tables);
}
