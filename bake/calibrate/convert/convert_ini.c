/* SPDX-License-Identifier: MIT */
/* Our files of cameras and fisheyes, read and written by the tables of their keys. */
#include <errno.h>

#include "bake/calibrate/convert/convert.h"

static void *place_camera(void *root, const char *instance)
{
	struct lens_ini *ini = root;

	(void)instance;
	ini->camera_given = true;
	return &ini->camera;
}

static void *place_fisheye(void *root, const char *instance)
{
	struct lens_ini *ini = root;

	(void)instance;
	ini->fisheye_given = true;
	return &ini->fisheye;
}

int lens_read_ini(struct lens_ini *ini, const char *path, struct fault *fault)
{
	static const struct ini_table tables[] = {
		{.section = "camera", .keys = tsai_keys, .place = place_camera},
		{.section = "fisheye", .keys = fisheye_keys, .place = place_fisheye},
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

		ini_value_text(key, values, text, sizeof(text));
		fprintf(to, "%s = %s\n", key->name, text);
	}
}

void lens_write_ini(FILE *to, const struct lens_ini *ini, const char *from, double error_px,
		    double turn_deg)
{
	fprintf(to, "; From %s, which knows the lens alone.\n", from);
	if (ini->camera_given)
		fputs("; Where the camera is stands here as none (rotation, translation), and "
		      "pixel is that of\n; a sensor of 36 mm: use it as inlay-calibrate camera "
		      "--intrinsics.\n",
		      to);
	else
		fputs("; How the camera is turned stands here as not at all (rotation), and what "
		      "the lens loses\n; to the rim as nothing (falloff).\n",
		      to);
	if (error_px > 0)
		fprintf(to,
			"; Fitted: it is off from what it was made of by at most %.3g px, besides "
			"a turn of\n; the camera by %.3g degrees.\n",
			error_px, turn_deg);
	if (ini->camera_given)
		lens_write_keys(to, "camera", tsai_keys, &ini->camera);
	else
		lens_write_keys(to, "fisheye", fisheye_keys, &ini->fisheye);
}
