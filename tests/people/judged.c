/* SPDX-License-Identifier: MIT */
#include "tests/people/judged.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

void judged_die(const char *what)
{
	fprintf(stderr, "%s\n", what);
	exit(1);
}

void *judged_make(size_t bytes)
{
	void *p = calloc(bytes, 1);

	if (!p)
		judged_die("not enough memory");
	return p;
}

void judged_open(struct judged *j, const char *folder, int room)
{
	struct fault fault = {{0}};
	struct people_settings settings;
	struct people_object object;
	char path[512];

	memset(j, 0, sizeof(*j));
	snprintf(path, sizeof(path), "%s/%d.room", folder, room);
	if (!recording_open(&j->recording, path))
		judged_die("cannot read a room: was it rendered?");
	snprintf(path, sizeof(path), "%s/%d.inlay", folder, room);
	if (basis_open(&j->basis, path, BASIS_SHOWN, &fault) ||
	    tsai_read_text(j->basis.camera, &j->camera, &fault) ||
	    dome_create(&j->dome, (int)j->basis.info.dome_frequency, &fault))
		judged_die(fault.text);
	settings = (struct people_settings){.width = j->camera.width,
					    .height = j->camera.height,
					    .curve = {.named = TRANSFER_SRGB},
					    .dome = &j->dome};
	if (people_create(&j->people, &settings, &fault))
		judged_die(fault.text);
	object = (struct people_object){.coverage = j->basis.poses[0].coverage,
					.touched = j->recording.touched,
					.camera = &j->camera,
					.foot = j->basis.feet};
	people_place(j->people, &object);
	j->pixels = j->camera.width * j->camera.height;
	j->bgrx = judged_make((size_t)j->pixels * 4);
	j->tile_near = judged_make((size_t)j->recording.head.tiles);
	for (int k = 0; k < j->pixels; k++)
		j->object += object.coverage[k] >= 32768;
}

void judged_close(struct judged *j)
{
	people_destroy(j->people);
	recording_close(&j->recording);
	basis_close(&j->basis);
	dome_free(&j->dome);
	free(j->bgrx);
	free(j->tile_near);
}

static double cpu_s(void)
{
	struct timespec now;

	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void judged_look(struct judged *j, int64_t captured_ns)
{
	const struct picture picture = {.origin = j->bgrx,
					.x_step = 4,
					.y_step = (ptrdiff_t)j->camera.width * 4,
					.width = j->camera.width,
					.height = j->camera.height};
	const double begin = cpu_s();

	people_look(j->people, &picture, (const float(*)[3])j->recording.light, captured_ns);
	j->look_s += cpu_s() - begin;
	j->looks++;
}

void judged_read(struct judged *j, int frame, int moved_px)
{
	const int width = j->camera.width;

	if (!recording_read(&j->recording, frame))
		judged_die("a room's file is cut short");
	for (int k = 0; k < j->pixels; k++) {
		const int from = k % width < moved_px ? k : k - moved_px;

		memcpy(j->bgrx + 4 * k, j->recording.bgr + 3 * from, 3);
		j->bgrx[4 * k + 3] = 255;
	}
}
