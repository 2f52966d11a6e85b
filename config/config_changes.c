/* SPDX-License-Identifier: MIT */
/* Compares two configurations key by key. */
#include <string.h>

#include "config/config.h"

static size_t value_bytes(const struct ini_key *key)
{
	switch (key->type) {
	case INI_BOOL:
		return sizeof(bool);
	case INI_REAL:
		return sizeof(double);
	case INI_LEVEL:
		return offsetof(struct ini_level, percent) + sizeof(bool); /* no padding */
	case INI_REALS:
	case INI_LIST:
		return key->count * sizeof(double);
	case INI_TEXT:
		return INI_TEXT_MAX;
	case INI_PATH:
		return INI_PATH_MAX;
	default:
		return sizeof(int);
	}
}

/* Texts are compared up to their NUL: the bytes behind it mean nothing. */
static bool is_same(const struct ini_key *key, const char *a, const char *b)
{
	if (key->type == INI_TEXT || key->type == INI_PATH)
		return strcmp(a + key->offset, b + key->offset) == 0;
	return memcmp(a + key->offset, b + key->offset, value_bytes(key)) == 0;
}

static void compare_table(struct config *config, const struct config *fresh,
			  const struct ini_table *table, const char *instance,
			  bool (*adopt)(void *context, const struct config_change *change),
			  void *context)
{
	char *old_values = (char *)table->place(config, instance) + table->part;
	/* place() takes a writable root, but changes nothing where the section exists. */
	const char *new_values = (char *)table->place((void *)fresh, instance) + table->part;

	for (const struct ini_key *key = table->keys; key->name; key++) {
		struct config_change change = {.section = table->section, .instance = instance};

		if (is_same(key, old_values, new_values))
			continue;
		snprintf(change.key, sizeof(change.key), "%s%s", table->prefix ? table->prefix : "",
			 key->name);
		if (adopt(context, &change))
			memcpy(old_values + key->offset, new_values + key->offset,
			       value_bytes(key));
	}
}

/* Reports the cameras of one configuration that the other lacks. */
static void compare_cameras(const struct config *one, const struct config *other,
			    bool (*adopt)(void *context, const struct config_change *change),
			    void *context)
{
	for (int i = 0; i < one->camera_count; i++) {
		const struct config_change change = {.section = "camera",
						     .instance = one->cameras[i]->name};

		if (!config_camera_named(other, one->cameras[i]->name))
			(void)adopt(context, &change);
	}
}

/* The contents of a light file may have changed under the same name. */
static void compare_light(const char *section, struct response *old, const struct response *fresh,
			  bool (*adopt)(void *context, const struct config_change *change),
			  void *context)
{
	const struct config_change change = {.section = section, .key = "light"};

	if (memcmp(old, fresh, sizeof(*old)) != 0 && adopt(context, &change))
		*old = *fresh;
}

/* Lamps have no device to open, so they come and go as a whole. */
static void compare_lamps(struct config *config, const struct config *fresh,
			  bool (*adopt)(void *context, const struct config_change *change),
			  void *context)
{
	const struct config_change change = {.section = "lamp"};
	struct lamps *old = &config->lamps;
	const struct lamps *now = &fresh->lamps;

	if (old->count == now->count && !memcmp(old->lamp, now->lamp, sizeof(old->lamp)) &&
	    !memcmp(config->lamp_name, fresh->lamp_name, sizeof(fresh->lamp_name)))
		return;
	if (!adopt(context, &change))
		return;
	old->count = now->count;
	memcpy(old->lamp, now->lamp, sizeof(old->lamp));
	memcpy(config->lamp_name, fresh->lamp_name, sizeof(fresh->lamp_name));
}

void config_update(struct config *config, const struct config *fresh,
		   bool (*adopt)(void *context, const struct config_change *change), void *context)
{
	for (const struct ini_table *table = config->tables; table->section; table++) {
		if (!table->named) {
			compare_table(config, fresh, table, NULL, adopt, context);
			continue;
		}
		for (int i = 0; strcmp(table->section, "camera") == 0 && i < config->camera_count;
		     i++) {
			const char *name = config->cameras[i]->name;

			if (config_camera_named(fresh, name))
				compare_table(config, fresh, table, name, adopt, context);
		}
	}
	compare_light("fisheye", &config->fisheye.measured, &fresh->fisheye.measured, adopt,
		      context);
	compare_light("background", &config->background.measured, &fresh->background.measured,
		      adopt, context);
	compare_lamps(config, fresh, adopt, context);
	compare_cameras(config, fresh, adopt, context);
	compare_cameras(fresh, config, adopt, context);
}
