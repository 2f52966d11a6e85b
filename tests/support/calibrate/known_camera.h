/* SPDX-License-Identifier: MIT */
/* Known Tsai cameras and the points that they see, for the tests of the camera's calibration. */
#ifndef INLAY_TESTS_SUPPORT_CALIBRATE_KNOWN_CAMERA_H
#define INLAY_TESTS_SUPPORT_CALIBRATE_KNOWN_CAMERA_H

#include <stdbool.h>

#include "bake/calibrate/camera/camera.h"
#include "tests/support/chance.h"

#define KNOWN_CAMERA_WIDTH 640
#define KNOWN_CAMERA_HEIGHT 480
#define KNOWN_CAMERA_STEP 0.03 /* between the corners of a board, in m */

/*
 * A camera at `eye` that looks at `target`, both in m. `bend` is kappa1 in units of the sensor's
 * half diagonal: 0.1 moves the corner of the picture by a tenth.
 */
struct tsai_camera known_camera(const double eye[3], const double target[3], double bend,
				int distortion);

/* The same camera, turned about its own axis by `angle` rad. */
struct tsai_camera known_camera_roll(struct tsai_camera c, double angle);

/* Adds one point, with noise of a standard deviation in px, unless the camera does not see it. */
void known_camera_see(struct observations *seen, const struct tsai_camera *camera,
		      const double world[3], double noise, struct chance *chance);

/* Adds a view of a board of columns x rows corners, in the plane z = 0 around the origin. */
void known_camera_see_board(struct observations *seen, const struct tsai_camera *camera,
			    int columns, int rows, double noise, struct chance *chance);

/* Adds a view of a board that is larger than the picture, without what is outside of it. */
void known_camera_see_large_board(struct observations *seen, const struct tsai_camera *camera,
				  double noise, struct chance *chance);

/* Adds a view of `count` points in a cube of 0.3 m around the origin, all inside the picture. */
void known_camera_see_cloud(struct observations *seen, const struct tsai_camera *camera, int count,
			    double noise, struct chance *chance);

/* A task with what a person knows of the camera: size of the picture, pixels, distortion's
 * direction. */
struct camera_task known_camera_task(const struct tsai_camera *camera);

/* The same, and the pixels' aspect is known, because one plane alone does not tell it. */
struct camera_task known_camera_task_of_plane(const struct tsai_camera *camera);

/* Whether the verdict trusts a solution. Prints the reason in TAP where it does not. */
bool known_camera_trusted(const struct camera_solution *solution);

#endif
