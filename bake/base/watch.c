/* SPDX-License-Identifier: MIT */
#include "bake/base/watch.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "hal/base/clock.h"
#include "hal/base/input.h"

#define LOOK_NS (100 * NS_PER_MS) /* between looks: a person who edits does not notice */
/* Programs write a file in parts, and several files one after the other. */
#define STORM_NS (1000 * NS_PER_MS) /* and some are never quiet */
/* Two changes within a tick of the file system's clock, at most 10 ms, leave the same time. */
#define TICK_NS (20 * NS_PER_MS)

struct watched_file {
	char *path;
	struct stat is; /* zeroed: it is not there */
};

struct watch {
	struct watched_file *files;
	int count, room;
	bool full; /* a file does not fit into memory */
};

int watch_create(struct watch **out, struct fault *fault)
{
	*out = calloc(1, sizeof(**out));
	return *out ? 0 : fault_say(fault, -ENOMEM, "out of memory");
}

static void watch_forget(struct watch *watch)
{
	while (watch->count)
		free(watch->files[--watch->count].path);
}

void watch_destroy(struct watch *watch)
{
	if (!watch)
		return;
	watch_forget(watch);
	free(watch->files);
	free(watch);
}

static void watch_sleep(int64_t ns)
{
	const struct timespec pause = {.tv_nsec = (long)ns};

	nanosleep(&pause, NULL);
}

static struct stat look_at_file(const char *path)
{
	struct stat is;

	if (stat(path, &is))
		memset(&is, 0, sizeof(is));
	return is;
}

static void watch_note(void *context, const char *path)
{
	struct watch *watch = context;
	struct watched_file *file;
	struct timespec now;

	if (watch->count == watch->room) {
		const int room = watch->room ? 2 * watch->room : 32;
		struct watched_file *files = realloc(watch->files, (size_t)room * sizeof(*files));

		watch->full |= !files;
		if (!files)
			return;
		watch->files = files;
		watch->room = room;
	}
	file = &watch->files[watch->count];
	file->path = strdup(path);
	watch->full |= !file->path;
	if (!file->path)
		return;
	file->is = look_at_file(path);
	clock_gettime(CLOCK_REALTIME, &now);
	if (llabs((now.tv_sec - file->is.st_ctim.tv_sec) * NS_PER_S + now.tv_nsec -
		  file->is.st_ctim.tv_nsec) < TICK_NS)
		watch_sleep(TICK_NS);
	watch->count++;
}

void watch_begin(struct watch *watch)
{
	watch_forget(watch);
	watch->full = false;
	input_observe(watch_note, watch);
}

int watch_end(struct watch *watch, struct fault *fault)
{
	input_observe(NULL, NULL);
	return watch->full ? fault_say(fault, -ENOMEM, "out of memory") : 0;
}

/* Whether a file is another one than when it was looked at last. */
static bool watch_look(struct watch *watch)
{
	bool changed = false;

	for (int k = 0; k < watch->count; k++) {
		const struct stat now = look_at_file(watch->files[k].path),
				  *then = &watch->files[k].is;

		changed |= now.st_dev != then->st_dev || now.st_ino != then->st_ino ||
			   now.st_size != then->st_size ||
			   now.st_ctim.tv_sec != then->st_ctim.tv_sec ||
			   now.st_ctim.tv_nsec != then->st_ctim.tv_nsec;
		watch->files[k].is = now;
	}
	return changed;
}

bool watch_wait(struct watch *watch, int limit_ms)
{
	const int64_t until_ns = clock_now_ns() + limit_ms * NS_PER_MS;
	int64_t storm_ns;

	while (!watch_look(watch)) {
		if (limit_ms >= 0 && clock_now_ns() >= until_ns)
			return false;
		watch_sleep(LOOK_NS);
	}
	storm_ns = clock_now_ns() + STORM_NS;
	do
		watch_sleep(LOOK_NS);
	while (watch_look(watch) && clock_now_ns() < storm_ns);
	return true;
}
