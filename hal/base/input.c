/* SPDX-License-Identifier: MIT */
#include "hal/base/input.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/magic.h>
#include <stdbool.h>
#include <stdlib.h>
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

/* Reads to the end; `room` is what is expected, and one more to see the end. */
static int read_all(int fd, size_t room, uint64_t most, uint8_t **data, size_t *bytes)
{
	uint8_t *buffer = malloc(room);
	size_t used = 0;
	ssize_t got = buffer ? 1 : 0;
	int err = buffer ? 0 : -ENOMEM;

	while (!err && got) {
		if (used == room) {
			uint8_t *larger = realloc(buffer, 2 * room);

			err = larger ? 0 : -ENOMEM;
			buffer = larger ? larger : buffer;
			room *= larger ? 2 : 1;
			continue;
		}
		got = read(fd, buffer + used, room - used);
		err = got < 0 && errno != EINTR ? -errno : 0;
		used += got > 0 ? (size_t)got : 0;
		if (used > most)
			err = -EFBIG;
	}
	if (err)
		free(buffer);
	else
		*data = buffer;
	*bytes = used;
	return err;
}

int input_read(const char *path, uint64_t most, uint8_t **data, size_t *bytes, struct fault *fault)
{
	const int fd = input_open(path, fault);
	struct stat is = {.st_size = 0};
	int err;

	*data = NULL;
	*bytes = 0;
	if (fd < 0)
		return fd;
	err = fstat(fd, &is) ? -errno : (uint64_t)is.st_size > most ? -EFBIG : 0;
	if (!err)
		err = read_all(fd, (size_t)is.st_size + 1, most, data, bytes);
	close(fd);
	if (err == -EFBIG)
		return fault_say(fault, err, "%s: more than %llu bytes long", path,
				 (unsigned long long)most);
	return err ? fault_say(fault, err, "%s: cannot be read: %s", path, strerror(-err)) : 0;
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
