/* SPDX-License-Identifier: MIT */
/* Reads the files of calibrations that the configuration names. */
#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "config/config.h"
#include "config/config_parts.h"
#include "hal/base/input.h"

/* The fault names the key, which the reader knows better than the file. */
static int check_readable(const struct config *config, const char *key, const char *path,
			  struct ini_report *report)
{
	struct stat about;
	int err;

	input_note(path);
	err = access(path, R_OK) == 0 && stat(path, &about) == 0 ? 0 : -errno;

	if (!err && S_ISDIR(about.st_mode))
		err = -EISDIR;
	if (!err)
		return 0;
	config_complain(config, report, "%s: cannot read \"%s\": %s", key, path, strerror(-err));
	return err;
}

struct config_lens_file {
	struct fisheye_settings *lens;
	bool found;
};

static void *lens_place(void *root, const char *instance)
{
	struct config_lens_file *file = root;

	(void)instance;
	file->found = true;
	return file->lens;
}

static int read_lens(struct config *config, struct ini_report *report)
{
	static const struct ini_table tables[] = {
		{.section = "fisheye", .keys = fisheye_keys, .place = lens_place},
		INI_TABLES_END,
	};
	const char *path = config->fisheye.lens_file;
	struct config_lens_file file = {.lens = &config->fisheye.lens};
	struct fault fault = {.text = ""};
	int err;

	if (!*path)
		return 0;
	err = check_readable(config, "[fisheye] lens", path, report);
	if (!err)
		err = ini_read(path, tables, &file, report);
	if (err || file.found)
		return err;
	fault_say(&fault, -EINVAL, "%s: expected a [fisheye] section", path);
	ini_report_add(report, &fault);
	return -EINVAL;
}

static void *camera_place(void *root, const char *instance)
{
	(void)instance;
	return root;
}

static int read_depth_camera(struct config *config, struct ini_report *report)
{
	static const struct ini_table tables[] = {
		{.section = "camera", .keys = tsai_keys, .place = camera_place},
		INI_TABLES_END,
	};
	const char *path = config->depth.calibration;
	struct tsai_camera camera = {.width = 0};
	struct fault fault = {.text = ""}, why = {.text = ""};
	int err;

	config->depth.camera.width = 0;
	if (!*path)
		return 0;
	ini_defaults(tsai_keys, &camera);
	err = check_readable(config, "[depth] calibration", path, report);
	if (!err)
		err = ini_read(path, tables, &camera, report);
	if (err)
		return err;
	err = tsai_check(&camera, &why);
	if (err) {
		fault_say(&fault, err, "%s: %s", path, why.text);
		ini_report_add(report, &fault);
		return err;
	}
	config->depth.camera = camera;
	return 0;
}

static int read_light(const struct config *config, const char *key, const char *path,
		      struct response *measured, struct ini_report *report)
{
	int err;

	response_begin(measured);
	if (!*path)
		return 0;
	err = check_readable(config, key, path, report);
	return err ? err : response_read(measured, path, report);
}

int config_read_files(struct config *config, struct ini_report *report)
{
	const int lens = read_lens(config, report);
	const int fisheye = read_light(config, "[fisheye] light", config->fisheye.light,
				       &config->fisheye.measured, report);
	const int background = read_light(config, "[background] light", config->background.light,
					  &config->background.measured, report);
	const int depth = read_depth_camera(config, report);

	return lens ? lens : fisheye ? fisheye : background ? background : depth;
}
