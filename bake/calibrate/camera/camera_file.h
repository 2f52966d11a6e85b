/* SPDX-License-Identifier: MIT */
/* A camera that was found, as files and people read it. */
#ifndef INLAY_BAKE_CALIBRATE_CAMERA_CAMERA_FILE_H
#define INLAY_BAKE_CALIBRATE_CAMERA_CAMERA_FILE_H

#include <stdio.h>

#include "bake/calibrate/camera/camera.h"

/* Section [camera] of the reference view; deviations, figures and verdict as comments. The file
 * appears whole. -errno. */
int camera_file_write(const char *path, const struct camera_solution *solution,
		      struct fault *fault);

/* The same figures as lines of text, each after this. */
void camera_print(FILE *to, const char *before, const struct camera_solution *solution);

#endif
