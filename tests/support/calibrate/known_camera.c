/* SPDX-License-Identifier: MIT */
#include "tests/support/calibrate/known_camera.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/optics/vec.h"

struct tsai_camera known_camera(const double eye[3], const double target[3], double bend,
				int distortion)
{
	struct tsai_camera c;
	double half;

	if (tsai_look_at(&c, KNOWN_CAMERA_WIDTH, KNOWN_CAMERA_HEIGHT, eye, target, 40, NULL))
		abort();
	c.focal /= c.pixel[0]; /* a calibration finds f in pixels */
	c.pixel[0] = c.pixel[1] = 1;
	half = hypot(KNOWN_CAMERA_WIDTH, KNOWN_CAMERA_HEIGHT) / 2;
	c.kappa1 = bend / (half * half);
	c.distortion = distortion;
	return c;
}

struct tsai_camera known_camera_roll(struct tsai_camera c, double angle)
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

void known_camera_see(struct observations *seen, const struct tsai_camera *camera,
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

void known_camera_see_board(struct observations *seen, const struct tsai_camera *camera,
			    int columns, int rows, double noise, struct chance *chance)
{
	if (observations_begin_view(seen, "board"))
		abort();
	for (int j = 0; j < rows; j++)
		for (int i = 0; i < columns; i++) {
			const double world[3] = {KNOWN_CAMERA_STEP * (i - (columns - 1) / 2.0),
						 KNOWN_CAMERA_STEP * (j - (rows - 1) / 2.0), 0};

			known_camera_see(seen, camera, world, noise, chance);
		}
}

void known_camera_see_large_board(struct observations *seen, const struct tsai_camera *camera,
				  double noise, struct chance *chance)
{
	if (observations_begin_view(seen, "board"))
		abort();
	for (int j = -5; j <= 5; j++)
		for (int i = -7; i <= 7; i++) {
			const double world[3] = {KNOWN_CAMERA_STEP * i, KNOWN_CAMERA_STEP * j, 0};
			double px[2];

			if (!tsai_project(camera, world, px) && px[0] > 0 && px[1] > 0 &&
			    px[0] < camera->width && px[1] < camera->height)
				known_camera_see(seen, camera, world, noise, chance);
		}
}

void known_camera_see_cloud(struct observations *seen, const struct tsai_camera *camera, int count,
			    double noise, struct chance *chance)
{
	if (observations_begin_view(seen, "cloud"))
		abort();
	while (count > 0) {
		const int before = seen->count;
		double world[3], px[2];

		for (int k = 0; k < 3; k++)
			world[k] = chance_real(chance, -0.15, 0.15);
		if (tsai_project(camera, world, px) || px[0] < 0 || px[0] > KNOWN_CAMERA_WIDTH ||
		    px[1] < 0 || px[1] > KNOWN_CAMERA_HEIGHT)
			continue;
		known_camera_see(seen, camera, world, noise, chance);
		count -= seen->count - before;
	}
}

struct camera_task known_camera_task(const struct tsai_camera *camera)
{
	struct camera_task task = camera_task_default();

	task.width = camera->width;
	task.height = camera->height;
	task.distortion = camera->distortion;
	return task;
}

struct camera_task known_camera_task_of_plane(const struct tsai_camera *camera)
{
	struct camera_task task = known_camera_task(camera);

	task.aspect_given = true;
	return task;
}

bool known_camera_trusted(const struct camera_solution *solution)
{
	char sentence[600];

	verdict_sentence(&solution->finding.verdict, sentence, sizeof(sentence));
	if (!solution->finding.verdict.trusted)
		printf("# %s\n", sentence);
	return solution->finding.verdict.trusted;
}
