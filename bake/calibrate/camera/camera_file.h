/* SPDX-License-Identifier: MIT */
/* Output of a calibrated camera: CAM.ini and text. */
#ifndef INLAY_BAKE_CALIBRATE_CAMERA_CAMERA_FILE_H
#define INLAY_BAKE_CALIBRATE_CAMERA_CAMERA_FILE_H

#include <stdio.h>

#include "bake/calibrate/camera/camera.h"

/* Writes section [camera] of the reference view, with deviations, figures and verdict as comments.
 * The file is replaced at once. -errno. */
int camera_file_write(const char *path, const struct camera_solution *solution,
		      struct fault *fault);

/* Prints the same figures as lines that begin with before. */
void camera_print(FILE *to, const char *before, const struct camera_solution *solution);

#endif
