/* SPDX-License-Identifier: MIT */
#include "hal/base/input.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/magic.h>
#include <stdbool.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

static struct {
	void (*seen)(void *context, const char *path);
	void *context;
} observer;

void input_observe(void (*seen)(void *context, const char *path), void *context)
{
	observer.seen = seen;
	observer.context = context;
}

void input_note(const char *path)
{
	if (observer.seen)
		observer.seen(observer.context, path);
}

/* The pipe of <(command) has no name in any folder; its path is /dev/fd/N. */
static bool is_unnamed_pipe(int fd)
{
	struct statfs is;

	return fstatfs(fd, &is) == 0 && is.f_type == PIPEFS_MAGIC;
}

static int input_refuse(mode_t mode, const char *path, struct fault *fault)
{
	return fault_say(fault, S_ISDIR(mode) ? -EISDIR : -EINVAL,
			 "%s: not a regular file but a %s, expected one to read", path,
			 S_ISDIR(mode)	  ? "folder"
			 : S_ISFIFO(mode) ? "named pipe"
			 : S_ISSOCK(mode) ? "socket"
					  : "device");
}

/* Checks the kind of the file and clears O_NONBLOCK, so that reads wait for a pipe's writer. */
static int check_file(int fd, const char *path, struct fault *fault)
{
	struct stat is;
	int err = fstat(fd, &is) ? -errno : 0;

	if (!err && !S_ISREG(is.st_mode) && !is_unnamed_pipe(fd))
		return input_refuse(is.st_mode, path, fault);
	if (!err && fcntl(fd, F_SETFL, 0))
		err = -errno;
	return err ? fault_say(fault, err, "%s: %s", path, strerror(-err)) : 0;
}

int input_open(const char *path, struct fault *fault)
{
	struct stat is;
	int fd, err;

	input_note(path);
	/* O_NONBLOCK: open() does not wait for the writer of a named pipe. */
	fd = open(path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
	err = fd < 0 ? -errno : 0;

	/* ENXIO: a socket, or a device that is absent. */
	if (err == -ENXIO && stat(path, &is) == 0)
		return input_refuse(is.st_mode, path, fault);
	if (err)
		return fault_say(fault, err, "%s: %s", path, strerror(-err));
	err = check_file(fd, path, fault);
	if (err)
		close(fd);
	return err ? err : fd;
}

int input_stream(const char *path, FILE **stream, struct fault *fault)
{
	const int fd = input_open(path, fault);
	int err;

	*stream = fd < 0 ? NULL : fdopen(fd, "r");
	if (fd < 0 || *stream)
		return fd < 0 ? fd : 0;
	err = -errno;
	close(fd);
	return fault_say(fault, err, "%s: %s", path, strerror(-err));
}
