/* SPDX-License-Identifier: MIT */
#include "config/config.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "config/config_parts.h"
#include "hal/lights/exposure_schedule.h"

/* The section that each class of driver has its keys in. */
static const struct {
	const char *section;
	size_t bytes; /* of the section's own struct */
} classes[CONFIG_CLASS_COUNT] = {
	[CONFIG_CAMERA] = {"camera", sizeof(struct config_camera)},
	[CONFIG_DISPLAY] = {"screen", sizeof(struct config_screen)},
	[CONFIG_BUTTONS] = {"buttons", sizeof(struct config_buttons)},
};

/* The table of a class's section, without its drivers' keys. */
static const struct ini_table *class_table(enum config_class kind)
{
	const struct ini_table *table = config_tables;

	while (strcmp(table->section, classes[kind].section) != 0)
		table++;
	return table;
}

/* ---- creating ---- */

static int driver_table_count(const struct config *config)
{
	int count = 0;

	for (int kind = 0; kind < CONFIG_CLASS_COUNT; kind++) {
		const struct config_driver *drivers = config->drivers.list[kind];

		for (int i = 0; drivers && drivers[i].name; i++)
			count += drivers[i].keys != NULL;
	}
	return count;
}

/* Copies the fixed tables and appends one for each driver that has keys. */
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
		const struct ini_table *section = class_table(kind);

		if (!drivers)
			config->tables[section - config_tables].keys = NULL;
		for (int i = 0; drivers && drivers[i].name; i++) {
			if (!drivers[i].keys)
				continue;
			config->tables[count++] = (struct ini_table){
				.section = section->section,
				.named = section->named,
				.prefix = config->prefix[kind][i],
				.keys = drivers[i].keys,
				.place = section->place,
				.part = config->option_offset[kind][i],
			};
		}
	}
	return 0;
}

/* Skips named sections, which have no struct until the file names them, and those that are not
 * read. */
static void defaults_fill(struct config *config)
{
	for (const struct ini_table *t = config->tables; t->section; t++) {
		if (!t->named && t->keys)
			ini_defaults(t->keys, (char *)t->place(config, NULL) + t->part);
	}
}

int config_create(struct config **out, const struct config_drivers *drivers)
{
	struct config *config = calloc(1, sizeof(*config));
	int err;

	if (!config)
		return -ENOMEM;
	if (drivers)
		config->drivers = *drivers;
	snprintf(config->name, sizeof(config->name), "configuration");
	for (int kind = 0; drivers && kind < CONFIG_CLASS_COUNT; kind++) {
		err = config_block_lay_out(config, kind, classes[kind].bytes);
		if (err)
			goto destroy;
	}
	err = tables_create(config);
	if (err)
		goto destroy;
	if (drivers) {
		config->screen = config_block_create(config, CONFIG_DISPLAY,
						     class_table(CONFIG_DISPLAY)->keys);
		config->buttons = config_block_create(config, CONFIG_BUTTONS,
						      class_table(CONFIG_BUTTONS)->keys);
	}
	if (drivers && (!config->screen || !config->buttons)) {
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

int config_exposures(const struct config_fisheye *fisheye)
{
	int count = 0;

	while (count < EXPOSURES_MAX && fisheye->exposures[count] > 0)
		count++;
	return count;
}

int config_exposure_delay(const struct config_fisheye *fisheye)
{
	if (fisheye->exposure_delay >= 0)
		return fisheye->exposure_delay;
	return fisheye->measured.delay <= EXPOSURE_DELAY_MAX ? fisheye->measured.delay : -1;
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
			/* A semicolon after a blank would begin a comment. */
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
		for (int i = 0; !strcmp(last, "camera") && i < config->camera_count; i++)
			print_section(config, last, config->cameras[i]->name, stream);
		for (int i = 0; !strcmp(last, "lamp") && i < config->lamps.count; i++)
			print_section(config, last, config->lamp_name[i], stream);
		if (!t->named)
			print_section(config, t->section, NULL, stream);
	}
}

void config_write_sample(const struct config *config, FILE *stream)
{
	ini_write_sample(stream, config->tables);
}
