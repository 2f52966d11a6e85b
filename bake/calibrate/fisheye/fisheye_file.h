/* SPDX-License-Identifier: MIT */
/* A fisheye lens as people and programs read it. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_FILE_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_FILE_H

#include <stdio.h>

#include "bake/calibrate/fisheye/fisheye_falloff.h"
#include "bake/calibrate/fisheye/fisheye_find.h"

/* What was found, a line each with before in front of it. */
void fisheye_print(FILE *to, const char *before, const struct fisheye_result *result);
void falloff_print(FILE *to, const char *before, const struct falloff *falloff);

/* An INI file of a section [fisheye] with what was found as comments; result and falloff may be
 * NULL. -errno. */
int fisheye_file_write(const char *path, const struct fisheye_settings *lens,
		       const struct fisheye_result *result, const struct falloff *falloff,
		       struct fault *fault);

#endif
