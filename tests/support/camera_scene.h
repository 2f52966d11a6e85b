/* SPDX-License-Identifier: MIT */
/* Cameras that are known, and what they see of points that are known. */
#ifndef INLAY_TESTS_SUPPORT_CAMERA_SCENE_H
#define INLAY_TESTS_SUPPORT_CAMERA_SCENE_H

#include <math.h>
#include <string.h>

#include "bake/calibrate/camera/camera.h"
#include "hal/optics/vec.h"
#include "tests/support/chance.h"

#define SCENE_WIDTH 640
#define SCENE_HEIGHT 480
#define SCENE_STEP 0.03 /* of boards, m */

static inline double chance_normal(struct chance *chance)
{
	return sqrt(-2 * log(chance_real(chance, 1e-300, 1))) *
	       cos(2 * M_PI * chance_real(chance, 0, 1));
}

/* A camera at eye that looks at target; kappa1 in units of the sensor's half diagonal: 0.1 moves
 * the corner of the picture by a tenth. */
static inline struct tsai_camera scene_camera(const double eye[3], const double target[3],
					      double bend, int distortion)
{
	struct tsai_camera c;
	double half;

	if (tsai_look_at(&c, SCENE_WIDTH, SCENE_HEIGHT, eye, target, 40, NULL))
		abort();
	half = hypot(SCENE_WIDTH, SCENE_HEIGHT) / 2 * c.pixel[0];
	c.kappa1 = bend / (half * half);
	c.distortion = distortion;
	return c;
}

/* The same camera, turned about its own axis. */
static inline struct tsai_camera scene_roll(struct tsai_camera c, double angle)
{
	const double turn[9] = {cos(angle), -sin(angle), 0, sin(angle), cos(angle), 0, 0, 0, 1};
	double rolled[9];

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			rolled[3 * i + j] = turn[3 * i] * c.rotation[j] +
					    turn[3 * i + 1] * c.rotation[3 + j] +
					    turn[3 * i + 2] * c.rotation[6 + j];
	memcpy(c.rotation, rolled, sizeof(rolled));
	mat_apply(turn, c.translation, c.translation);
	return c;
}

/* What a camera sees of one point, with noise of px; points it does not see are left out. */
static inline void scene_see(struct observations *seen, const struct tsai_camera *camera,
			     const double world[3], double noise, struct chance *chance)
{
	double px[2];

	if (tsai_project(camera, world, px))
		return;
	for (int k = 0; k < 2; k++)
		px[k] += noise > 0 ? noise * chance_normal(chance) : 0;
	if (observations_add(seen, world, px, "point %d", seen->count + 1))
		abort();
}

/* A board in the plane z = 0 around the origin, columns x rows. */
static inline void scene_board(struct observations *seen, const struct tsai_camera *camera,
			       int columns, int rows, double noise, struct chance *chance)
{
	if (observations_begin_view(seen, "board"))
		abort();
	for (int j = 0; j < rows; j++)
		for (int i = 0; i < columns; i++) {
			const double world[3] = {SCENE_STEP * (i - (columns - 1) / 2.0),
						 SCENE_STEP * (j - (rows - 1) / 2.0), 0};

			scene_see(seen, camera, world, noise, chance);
		}
}

/* Points in space around the origin. */
static inline void scene_cloud(struct observations *seen, const struct tsai_camera *camera,
			       int count, double noise, struct chance *chance)
{
	if (observations_begin_view(seen, "cloud"))
		abort();
	while (count > 0) {
		const int before = seen->count;
		double world[3], px[2];

		for (int k = 0; k < 3; k++)
			world[k] = chance_real(chance, -0.15, 0.15);
		if (tsai_project(camera, world, px) || px[0] < 0 || px[0] > SCENE_WIDTH ||
		    px[1] < 0 || px[1] > SCENE_HEIGHT)
			continue;
		scene_see(seen, camera, world, noise, chance);
		count -= seen->count - before;
	}
}

/* A task that knows of the camera what a person does: picture, pixels, direction. */
static inline struct camera_task scene_task(const struct tsai_camera *camera)
{
	struct camera_task task = camera_task_default();

	task.width = camera->width;
	task.height = camera->height;
	memcpy(task.pixel, camera->pixel, sizeof(task.pixel));
	task.distortion = camera->distortion;
	return task;
}

/* The same of one who knows, too, that the pixels are as scene_camera() makes them: a lone plane
 * does not tell. */
static inline struct camera_task scene_task_of_plane(const struct tsai_camera *camera)
{
	struct camera_task task = scene_task(camera);

	task.aspect_given = true;
	return task;
}

/* Says why not. */
static inline bool scene_trusted(const struct camera_solution *solution)
{
	char sentence[600];

	verdict_sentence(&solution->finding.verdict, sentence, sizeof(sentence));
	if (!solution->finding.verdict.trusted)
		printf("# %s\n", sentence);
	return solution->finding.verdict.trusted;
}

#endif
