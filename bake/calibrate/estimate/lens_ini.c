/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/estimate/lens_ini.h"

#include <errno.h>

static void *place_lens_camera(void *root, const char *instance)
{
	struct lens_ini *ini = root;

	(void)instance;
	ini->camera_given = true;
	return &ini->camera;
}

static void *place_lens_fisheye(void *root, const char *instance)
{
	struct lens_ini *ini = root;

	(void)instance;
	ini->fisheye_given = true;
	return &ini->fisheye;
}

int lens_read_ini(struct lens_ini *ini, const char *path, struct fault *fault)
{
	static const struct ini_table tables[] = {
		{.section = "camera", .keys = tsai_keys, .place = place_lens_camera},
		{.section = "fisheye", .keys = fisheye_keys, .place = place_lens_fisheye},
		INI_TABLES_END,
	};
	struct ini_report report = {.count = 0};
	int err;

	*ini = (struct lens_ini){.camera_given = false};
	ini_defaults(tsai_keys, &ini->camera);
	ini_defaults(fisheye_keys, &ini->fisheye);
	err = ini_read(path, tables, ini, &report);
	if (err) {
		if (fault)
			*fault = report.first;
		return err;
	}
	if (ini->camera_given == ini->fisheye_given)
		return fault_say(fault, -EINVAL, "%s: expected a section [camera] or [fisheye]",
				 path);
	return 0;
}

void lens_write_keys(FILE *to, const char *section, const struct ini_key *keys, const void *values)
{
	fprintf(to, "[%s]\n", section);
	for (const struct ini_key *key = keys; key->name; key++) {
		char text[512];

		if (ini_left_out(key, values))
			continue;
		ini_value_text(key, values, text, sizeof(text));
		fprintf(to, "%s = %s\n", key->name, text);
	}
}
