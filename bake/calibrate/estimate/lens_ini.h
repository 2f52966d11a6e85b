/* SPDX-License-Identifier: MIT */
/* Lenses in our INI files: CAM.ini has a section [camera], EYE.ini a section [fisheye]. */
#ifndef INLAY_BAKE_CALIBRATE_ESTIMATE_LENS_INI_H
#define INLAY_BAKE_CALIBRATE_ESTIMATE_LENS_INI_H

#include <stdbool.h>
#include <stdio.h>

#include "hal/base/fault.h"
#include "hal/ini/ini.h"
#include "hal/optics/fisheye.h"
#include "hal/optics/tsai.h"

/* What such a file holds. */
struct lens_ini {
	bool camera_given, fisheye_given;
	struct tsai_camera camera;
	struct fisheye_settings fisheye;
};

/* Reads one. -ENOENT...; -EINVAL: a wrong key, neither of the two sections, or both. */
int lens_read_ini(struct lens_ini *ini, const char *path, struct fault *fault);

/* Writes "[section]" and its keys, one a line. */
void lens_write_keys(FILE *to, const char *section, const struct ini_key *keys, const void *values);

#endif
