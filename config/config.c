#include "config/config.h"

#include <errno.h>
#include <stdalign.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

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

/* The next of the words that blanks or commas separate, cut to size; false at the end. */
static bool next_word(const char **text, char word[CONFIG_NAME_MAX])
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

	while (next_word(&text, word)) {
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

/* ---- checking ---- */

__attribute__((format(printf, 3, 4))) static void
complain(const struct config *config, struct ini_report *report, const char *format, ...)
{
	char what[FAULT_TEXT_MAX - INI_PATH_MAX / 2];
	struct fault fault = {.text = ""};
	va_list args;

	va_start(args, format);
	vsnprintf(what, sizeof(what), format, args);
	va_end(args);
	fault_say(&fault, -EINVAL, "%.500s: %s", config->name, what);
	if (!report->count++)
		report->first = fault;
	if (report->say)
		report->say(report->context, fault.text);
}

static void check_driver(const struct config *config, enum config_class kind, const char *title,
			 const char *name, struct ini_report *report)
{
	const char *names[CONFIG_DRIVERS_MAX + 1];
	const struct config_driver *drivers = config->drivers.list[kind];
	size_t count = 0;
	char all[256] = "";
	const char *near;

	for (; drivers[count].name; count++) {
		names[count] = drivers[count].name;
		snprintf(all + strlen(all), sizeof(all) - strlen(all), "%s%s", count ? ", " : "",
			 names[count]);
	}
	if (config_driver_index(config, kind, name) >= 0)
		return;
	near = ini_nearest(name, names, count);
	complain(config, report, "[%s] driver: is \"%.60s\", expected one of %s%s%s%s%s", title,
		 name, kind == CONFIG_BUTTONS ? "none, " : "", all, near ? "; did you mean \"" : "",
		 near ? near : "", near ? "\"?" : "");
}

/* A name that stands for many files ("%04d.png", "*.png") is left to its driver. */
static void check_files(const struct config *config, enum config_class kind, const char *title,
			const char *driver, void *block, struct ini_report *report)
{
	int index = config_driver_index(config, kind, driver);
	const struct ini_key *keys;

	if (index < 0)
		return;
	keys = config->drivers.list[kind][index].keys;
	for (const struct ini_key *key = keys; key && key->name; key++) {
		const char *path = (const char *)config_options(config, kind, block, index) +
				   key->offset;

		if (key->type != INI_PATH || !*path || strpbrk(path, "%*?"))
			continue;
		if (access(path, R_OK) != 0)
			complain(config, report, "[%s] %s%s: cannot read \"%s\": %s", title,
				 config->prefix[kind][index], key->name, path, strerror(errno));
	}
}

static void check_view(const struct config *config, const char *section,
		       const struct config_view *view, bool needed, struct ini_report *report)
{
	const char *names[CONFIG_CAMERAS_MAX];
	const char *near;

	if (!*view->camera) {
		if (needed)
			complain(config, report,
				 "[%s] camera: is empty, expected the name of a [camera NAME]",
				 section);
		return;
	}
	if (config_camera_named(config, view->camera))
		return;
	for (int i = 0; i < config->camera_count; i++)
		names[i] = config->cameras[i]->name;
	near = ini_nearest(view->camera, names, (size_t)config->camera_count);
	complain(config, report, "[%s] camera: there is no section [camera %.60s]%s%s%s", section,
		 view->camera, near ? "; did you mean \"" : "", near ? near : "",
		 near ? "\"?" : "");
}

static void check_buttons(const struct config *config, struct ini_report *report)
{
	const char *text = config->buttons->driver;
	char word[CONFIG_NAME_MAX];

	while (next_word(&text, word)) {
		if (!strcmp(word, "none"))
			continue;
		check_driver(config, CONFIG_BUTTONS, "buttons", word, report);
		check_files(config, CONFIG_BUTTONS, "buttons", word, config->buttons, report);
	}
}

int config_check(const struct config *config, struct ini_report *report)
{
	int before = report->count;

	if (!*config->basis.file)
		complain(config, report,
			 "[basis] file: is empty, expected the basis file that inlay-bake made");
	for (int i = 0; i < config->camera_count; i++) {
		struct config_camera *camera = config->cameras[i];
		char title[CONFIG_NAME_MAX + 16];

		snprintf(title, sizeof(title), "camera %s", camera->name);
		check_driver(config, CONFIG_CAMERA, title, camera->driver, report);
		check_files(config, CONFIG_CAMERA, title, camera->driver, camera, report);
	}
	check_view(config, "fisheye", &config->fisheye.view, true, report);
	check_view(config, "background", &config->background.view, true, report);
	check_view(config, "scene", &config->scene.view, false, report);
	if (config->screen->show == SHOW_SCENE && !*config->scene.view.camera)
		complain(config, report,
			 "[screen] show: is scene, but [scene] camera is empty; expected the name "
			 "of a [camera NAME] there");
	check_driver(config, CONFIG_DISPLAY, "screen", config->screen->driver, report);
	check_buttons(config, report);
	return report->count > before ? -EINVAL : 0;
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
