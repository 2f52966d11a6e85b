/* SPDX-License-Identifier: MIT */
/* Checks keys against each other, and against the files and drivers that they name. */
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "config/config_parts.h"

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
	config_complain(config, report, "[%s] driver: is \"%.60s\", expected one of %s%s%s%s%s",
			title, name, kind == CONFIG_BUTTONS ? "none, " : "", all,
			near ? "; did you mean \"" : "", near ? near : "", near ? "\"?" : "");
}

/* Leaves names that stand for many files ("%04d.png", "*.png") to the driver. */
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
			config_complain(config, report, "[%s] %s%s: cannot read \"%s\": %s", title,
					config->prefix[kind][index], key->name, path,
					strerror(errno));
	}
}

static void check_view_camera(const struct config *config, const char *section,
			      const struct config_view *view, bool needed,
			      struct ini_report *report)
{
	const char *names[CONFIG_CAMERAS_MAX];
	const char *near;

	if (!*view->camera) {
		if (needed)
			config_complain(
				config, report,
				"[%s] camera: is empty, expected the name of a [camera NAME]",
				section);
		return;
	}
	if (config_camera_named(config, view->camera))
		return;
	for (int i = 0; i < config->camera_count; i++)
		names[i] = config->cameras[i]->name;
	near = ini_nearest(view->camera, names, (size_t)config->camera_count);
	config_complain(config, report, "[%s] camera: there is no section [camera %.60s]%s%s%s",
			section, view->camera, near ? "; did you mean \"" : "", near ? near : "",
			near ? "\"?" : "");
}

/* A camera that measures depths sends no other pictures. */
static void check_depth(const struct config *config, struct ini_report *report)
{
	const char *name = config->depth.view.camera;
	const struct config_camera *camera = config_camera_named(config, name);
	const int format = camera ? camera->settings.format : PIXEL_NONE;

	if (*name && (!strcmp(name, config->fisheye.view.camera) ||
		      !strcmp(name, config->background.view.camera) ||
		      !strcmp(name, config->scene.view.camera)))
		config_complain(
			config, report,
			"[depth] camera: camera %.60s is seen by another view too, expected a camera of its own",
			name);
	if (format != PIXEL_NONE && format != PIXEL_Z16)
		config_complain(
			config, report,
			"[camera %.60s] format: is %s, but [depth] looks through it; expected Z16 or none",
			name, pixel_format_names[format]);
}

static void check_exposures(const struct config *config, struct ini_report *report)
{
	const struct config_fisheye *fisheye = &config->fisheye;
	const int count = config_exposures(fisheye);

	if (count == 1)
		config_complain(config, report,
				"[fisheye] exposures: is one value, expected 2 to %d, or none",
				EXPOSURES_MAX);
	for (int k = 1; k < count; k++)
		if (!(fisheye->exposures[k] <= fisheye->exposures[k - 1] / 1.5))
			config_complain(
				config, report,
				"[fisheye] exposures: %g comes after %g, expected each to be at most two thirds of the one before it",
				fisheye->exposures[k], fisheye->exposures[k - 1]);
	if (count && !*fisheye->exposure_control)
		config_complain(
			config, report,
			"[fisheye] exposure_control: is empty, expected the name of a control");
	if (count && (!strcmp(fisheye->view.camera, config->background.view.camera) ||
		      !strcmp(fisheye->view.camera, config->scene.view.camera)))
		config_complain(
			config, report,
			"[fisheye] exposures: camera %.60s is seen by another view too, expected a camera of its own",
			fisheye->view.camera);
}

static void check_patch(const struct config *config, struct ini_report *report)
{
	const double *patch = config->background.patch;

	for (int k = 0; k < 4; k++)
		if (patch[k] != floor(patch[k]) || (patch[2] > 0) != (patch[3] > 0)) {
			config_complain(
				config, report,
				"[background] ground_patch: is %g %g %g %g, expected whole pixels, and a width and a height",
				patch[0], patch[1], patch[2], patch[3]);
			return;
		}
}

/* The dome begins at the lens's height: what lies below is not measured. */
static void check_lamps(const struct config *config, struct ini_report *report)
{
	const struct lamps *lamps = &config->lamps;

	for (int i = 0; i < lamps->count; i++) {
		const struct lamp *lamp = &lamps->lamp[i];
		const double *at = lamp->position, *eye = lamps->fisheye;
		const double apart = hypot(hypot(at[0] - eye[0], at[1] - eye[1]), at[2] - eye[2]);

		if (apart <= lamp->radius)
			config_complain(
				config, report,
				"[lamp %s] position: is %g %g %g, %g m from the fisheye's; expected more than its radius of %g m",
				config->lamp_name[i], at[0], at[1], at[2], apart, lamp->radius);
		else if (at[2] <= eye[2])
			config_complain(
				config, report,
				"[lamp %s] position: is %g %g %g, expected Z above the fisheye's %g m",
				config->lamp_name[i], at[0], at[1], at[2], eye[2]);
	}
}

static void check_buttons(const struct config *config, struct ini_report *report)
{
	const char *text = config->buttons->driver;
	char word[CONFIG_NAME_MAX];

	while (config_next_word(&text, word)) {
		if (!strcmp(word, "none"))
			continue;
		check_driver(config, CONFIG_BUTTONS, "buttons", word, report);
		check_files(config, CONFIG_BUTTONS, "buttons", word, config->buttons, report);
	}
}

static bool same_file(const struct stat *about, const char *path)
{
	struct stat other;

	return *path && stat(path, &other) == 0 && other.st_dev == about->st_dev &&
	       other.st_ino == about->st_ino;
}

/* A file that the kiosk writes replaces what has its name. */
static void check_written(const struct config *config, const char *section, const char *path,
			  struct ini_report *report)
{
	const char *const read[] = {
		config->name,	       config->basis.file,	 config->fisheye.lens_file,
		config->fisheye.light, config->background.light, config->depth.calibration};
	struct stat about;

	if (!*path || stat(path, &about))
		return;
	if (!S_ISREG(about.st_mode))
		config_complain(
			config, report,
			"[%s] file: \"%s\" is a folder, pipe or device, expected a file that may be replaced",
			section, path);
	for (size_t i = 0; i < sizeof(read) / sizeof(read[0]); i++)
		if (same_file(&about, read[i]))
			config_complain(
				config, report,
				"[%s] file: \"%s\" would replace \"%s\", which is read; expected a file of its own",
				section, path, read[i]);
}

int config_check(const struct config *config, struct ini_report *report)
{
	int before = report->count;

	if (!*config->basis.file)
		config_complain(
			config, report,
			"[basis] file: is empty, expected the basis file that inlay-bake made");
	for (int i = 0; i < config->camera_count; i++) {
		struct config_camera *camera = config->cameras[i];
		char title[CONFIG_NAME_MAX + 16];

		snprintf(title, sizeof(title), "camera %s", camera->name);
		check_driver(config, CONFIG_CAMERA, title, camera->driver, report);
		check_files(config, CONFIG_CAMERA, title, camera->driver, camera, report);
		if (camera->turn != PICTURE_UPRIGHT && camera->settings.format == PIXEL_RGBF)
			config_complain(
				config, report,
				"[%s] rotate: pictures of linear light (format = RGBF) are not turned, expected 0 or another format",
				title);
	}
	check_view_camera(config, "fisheye", &config->fisheye.view, true, report);
	check_view_camera(config, "background", &config->background.view, true, report);
	check_view_camera(config, "scene", &config->scene.view, false, report);
	check_view_camera(config, "depth", &config->depth.view, false, report);
	check_depth(config, report);
	check_exposures(config, report);
	check_patch(config, report);
	check_lamps(config, report);
	if (config->screen->show == SHOW_SCENE && !*config->scene.view.camera)
		config_complain(
			config, report,
			"[screen] show: is scene, but [scene] camera is empty; expected the name of a [camera NAME] there");
	check_driver(config, CONFIG_DISPLAY, "screen", config->screen->driver, report);
	check_buttons(config, report);
	check_written(config, "metrics", config->metrics.file, report);
	check_written(config, "state", config->state.file, report);
	return report->count > before ? -EINVAL : 0;
}

void config_complain(const struct config *config, struct ini_report *report, const char *format,
		     ...)
{
	char what[FAULT_TEXT_MAX - INI_PATH_MAX / 2];
	struct fault fault = {.text = ""};
	va_list args;

	va_start(args, format);
	vsnprintf(what, sizeof(what), format, args);
	va_end(args);
	fault_say(&fault, -EINVAL, "%.500s: %s", config->name, what);
	ini_report_add(report, &fault);
}
