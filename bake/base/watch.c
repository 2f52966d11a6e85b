/* SPDX-License-Identifier: MIT */
#include "bake/base/watch.h"

#include <errno.h>
#include <limits.h>
#include <poll.h>
#include <stdalign.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/inotify.h>
#include <unistd.h>

#include "hal/base/clock.h"
#include "hal/base/input.h"

/* Programs write a file in parts, and several files one after the other. */
#define QUIET_NS (100 * NS_PER_MS)
#define STORM_NS (1000 * NS_PER_MS) /* and some are never quiet */
#define LINKS_MAX 40		    /* as many as Linux follows */
#define CHANGES                                                                                    \
	(IN_CLOSE_WRITE | IN_CREATE | IN_DELETE | IN_MOVED_FROM | IN_MOVED_TO | IN_ATTRIB |        \
	 IN_DELETE_SELF | IN_MOVE_SELF)

struct watched_file {
	int folder; /* inotify's number of it */
	char name[NAME_MAX + 1];
};

struct watch {
	int fd;
	struct watched_file *files;
	int count, room;
	int err; /* of the first file that cannot be watched */
	char failed[PATH_MAX];
};

int watch_create(struct watch **out, struct fault *fault)
{
	struct watch *watch = calloc(1, sizeof(*watch));
	int err;

	if (!watch)
		return fault_say(fault, -ENOMEM, "out of memory");
	watch->fd = inotify_init1(IN_CLOEXEC | IN_NONBLOCK);
	if (watch->fd < 0) {
		err = -errno;
		free(watch);
		return fault_say(fault, err, "files cannot be watched: %s", strerror(-err));
	}
	*out = watch;
	return 0;
}

void watch_destroy(struct watch *watch)
{
	if (!watch)
		return;
	close(watch->fd);
	free(watch->files);
	free(watch);
}

/* ---- files ---- */

static int watch_add(struct watch *watch, int folder, const char *name)
{
	for (int k = 0; k < watch->count; k++)
		if (watch->files[k].folder == folder && !strcmp(watch->files[k].name, name))
			return 0;
	if (watch->count == watch->room) {
		const int room = watch->room ? 2 * watch->room : 32;
		struct watched_file *files = realloc(watch->files,
						     (size_t)room * sizeof(*watch->files));

		if (!files)
			return -ENOMEM;
		watch->files = files;
		watch->room = room;
	}
	watch->files[watch->count].folder = folder;
	snprintf(watch->files[watch->count++].name, NAME_MAX + 1, "%s", name);
	return 0;
}

/* Watches the name in its folder; where there is no such folder, the folder's own name in the one
 * above, and so on. */
static int watch_path(struct watch *watch, const char *path)
{
	char folder[PATH_MAX], *slash, *name;

	if (snprintf(folder, sizeof(folder), "%s%s", *path == '/' ? "" : "./", path) >= PATH_MAX)
		return -ENAMETOOLONG;
	while ((slash = strrchr(folder, '/'))) {
		int number;

		*slash = '\0';
		name = slash + 1;
		if (!*name) /* slashes in a row, and at the end */
			continue;
		number = inotify_add_watch(watch->fd, *folder ? folder : "/", CHANGES | IN_ONLYDIR);
		if (number >= 0)
			return watch_add(watch, number, name);
		if (errno != ENOENT && errno != ENOTDIR)
			return -errno;
	}
	return -ENOENT;
}

/* Follows the first symbolic link of a path, of a folder or of the file: writes where it leads. 1;
 * 0: there is none; -errno. */
static int watch_link(struct watch *watch, char path[PATH_MAX])
{
	char target[PATH_MAX], whole[2 * PATH_MAX];

	for (char *end = path; *end;) {
		const char *slash;
		ssize_t length;
		char rest;
		int err;

		end += strspn(end, "/");
		end += strcspn(end, "/");
		rest = *end;
		*end = '\0';
		length = readlink(path, target, sizeof(target));
		if (length < 0) {
			*end = rest;
			continue;
		}
		err = watch_path(watch, path);
		slash = strrchr(path, '/');
		snprintf(whole, sizeof(whole), "%.*s%.*s%s%s",
			 *target == '/' || !slash ? 0 : (int)(slash - path) + 1, path, (int)length,
			 target, rest ? "/" : "", rest ? end + 1 : "");
		if (!err && strlen(whole) >= PATH_MAX)
			err = -ENAMETOOLONG;
		if (!err)
			memcpy(path, whole, strlen(whole) + 1);
		return err ? err : 1;
	}
	return 0;
}

static void watch_note(void *context, const char *path)
{
	struct watch *watch = context;
	char followed[PATH_MAX];
	int err = 1;

	snprintf(followed, sizeof(followed), "%s", path);
	for (int links = 0; links < LINKS_MAX && err == 1; links++)
		err = watch_link(watch, followed);
	if (err >= 0)
		err = watch_path(watch, followed);
	if (err && !watch->err) {
		watch->err = err;
		snprintf(watch->failed, sizeof(watch->failed), "%s", path);
	}
}

/* ---- changes ---- */

static bool watch_concerns(const struct watch *watch, const struct inotify_event *event)
{
	if (event->mask & IN_Q_OVERFLOW)
		return true;
	for (int k = 0; k < watch->count; k++)
		if (watch->files[k].folder == event->wd &&
		    (!event->len ? (event->mask & (IN_DELETE_SELF | IN_MOVE_SELF | IN_IGNORED)) != 0
				 : !strcmp(watch->files[k].name, event->name)))
			return true;
	return false;
}

/* Reads what has happened. Returns whether one of the files has changed, or -errno. */
static int watch_read(const struct watch *watch)
{
	alignas(struct inotify_event) char events[8192];
	int changed = 0;
	ssize_t bytes;

	while ((bytes = read(watch->fd, events, sizeof(events))) > 0)
		for (const char *at = events; at < events + bytes;) {
			const struct inotify_event *event = (const void *)at;

			changed |= watch_concerns(watch, event);
			at += sizeof(*event) + event->len;
		}
	return bytes < 0 && errno != EAGAIN && errno != EINTR ? -errno : changed;
}

void watch_begin(struct watch *watch)
{
	watch->count = 0;
	(void)watch_read(watch); /* what has changed until now will be read as it is */
	watch->err = 0;
	input_observe(watch_note, watch);
}

int watch_end(struct watch *watch, struct fault *fault)
{
	input_observe(NULL, NULL);
	if (!watch->err)
		return 0;
	return fault_say(fault, watch->err, "%s: cannot be watched: %s", watch->failed,
			 strerror(-watch->err));
}

int watch_wait(struct watch *watch, int limit_ms, struct fault *fault)
{
	struct pollfd ready = {.fd = watch->fd, .events = POLLIN};
	int64_t until_ns = clock_now_ns() + limit_ms * NS_PER_MS;
	int64_t storm_ns = INT64_MAX;
	bool changed = false, limited = limit_ms >= 0;
	int ret = 0;

	while (ret >= 0) {
		const int64_t left_ns = until_ns - clock_now_ns();

		if (limited && left_ns <= 0)
			return changed;
		ret = poll(&ready, 1, limited ? (int)(left_ns / NS_PER_MS) + 1 : -1);
		if (ret < 0)
			ret = errno == EINTR ? 0 : -errno;
		else if (ret > 0)
			ret = watch_read(watch);
		if (ret > 0) {
			if (!changed)
				storm_ns = clock_now_ns() + STORM_NS;
			changed = limited = true;
			until_ns = clock_now_ns() + QUIET_NS;
			until_ns = until_ns < storm_ns ? until_ns : storm_ns;
		}
	}
	return fault_say(fault, ret, "files cannot be watched: %s", strerror(-ret));
}
