/* SPDX-License-Identifier: MIT */
/*
 * Measures the time of a camera's calibration: with a thousand points; with photographs as
 * arguments (first the board), of finding the board in each and of solving each alone.
 *
 *	bench_camera [9x6:25mm left01.jpg ...]
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "bake/calibrate/camera/camera.h"
#include "bake/calibrate/observe/boards.h"
#include "hal/image/image.h"
#include "tests/support/calibrate/known_camera.h"
#include "tests/support/chance.h"

#define REPEATS 10

/* Time of the processor, so that other programs on the machine do not count. */
static double now_ms(void)
{
	struct timespec t;

	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

static void time_points(const struct observations *seen, const struct camera_task *task,
			const char *what)
{
	double least = INFINITY;

	for (int k = 0; k < REPEATS; k++) {
		const double begin = now_ms();
		struct camera_solution solution;

		if (camera_calibrate(seen, task, &solution, NULL))
			abort();
		least = fmin(least, now_ms() - begin);
		camera_solution_free(&solution);
	}
	printf("%d points, %s: %.1f ms (the fastest of %d)\n", seen->count, what, least, REPEATS);
}

static void thousand_points(void)
{
	static const char *const what[] = {"of a plane", "of a plane, robustly", "in space",
					   "in space, robustly"};
	const double eye[3] = {0.15, -0.55, 0.6}, target[3] = {0.01, 0.005, 0};
	struct chance chance = {1};

	for (int distortion = 0; distortion < 2; distortion++) {
		const struct tsai_camera truth = known_camera(eye, target, -0.05, distortion);

		printf("%s:\n", tsai_distortion_names[distortion]);
		for (int k = 0; k < 4; k++) {
			struct camera_task task = known_camera_task(&truth);
			struct observations seen = {0};

			task.robust = k & 1;
			if (k < 2)
				known_camera_see_board(&seen, &truth, 40, 25, 0.2, &chance);
			else
				known_camera_see_cloud(&seen, &truth, 1000, 0.2, &chance);
			time_points(&seen, &task, what[k]);
			observations_free(&seen);
		}
	}
}

static int photograph(struct board *board, const char *path)
{
	struct camera_task task = camera_task_default();
	struct camera_solution solution;
	struct observations seen = {0};
	struct fault fault = {""};
	struct image picture;
	double begin, found, solved;

	if (image_read(path, &picture, &fault)) {
		fprintf(stderr, "%s\n", fault.text);
		return 1;
	}
	begin = now_ms();
	if (board_find(board, &picture, path, &seen, &fault)) {
		printf("%s: %s\n", path, fault.text);
	} else {
		found = now_ms();
		task.width = seen.width;
		task.height = seen.height;
		if (camera_calibrate(&seen, &task, &solution, &fault))
			abort();
		solved = now_ms();
		printf("%s, %.2f megapixels: found in %.1f ms, solved in %.1f ms\n", path,
		       1e-6 * picture.width * picture.height, found - begin, solved - found);
		camera_solution_free(&solution);
	}
	observations_free(&seen);
	image_free(&picture);
	return 0;
}

int main(int argc, char **argv)
{
	struct fault fault = {""};
	struct board board;

	thousand_points();
	if (argc > 1 && board_parse(&board, argv[1], &fault)) {
		fprintf(stderr, "%s\n", fault.text);
		return 2;
	}
	for (int k = 2; k < argc; k++)
		if (photograph(&board, argv[k]))
			return 1;
	return 0;
}
