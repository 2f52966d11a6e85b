/* SPDX-License-Identifier: MIT */
/* Output of a calibrated fisheye: text and EYE.ini. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_FILE_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_FILE_H

#include <stdio.h>

#include "bake/calibrate/fisheye/fisheye_falloff.h"
#include "bake/calibrate/fisheye/fisheye_find.h"

/* Print the result as lines that begin with before. */
void fisheye_print(FILE *to, const char *before, const struct fisheye_result *result);
void falloff_print(FILE *to, const char *before, const struct falloff *falloff);

/* Writes an INI file with a section [fisheye] and the results as comments; result and falloff may
 * be NULL. -errno. */
int fisheye_file_write(const char *path, const struct fisheye_settings *lens,
		       const struct fisheye_result *result, const struct falloff *falloff,
		       struct fault *fault);

#endif
