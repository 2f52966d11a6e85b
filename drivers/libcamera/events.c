/* SPDX-License-Identifier: MIT */
#include "drivers/libcamera/parts.h"

#include <errno.h>
#include <fcntl.h>
#include <glob.h>
#include <poll.h>
#include <stdalign.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/base/clock.h"

enum { OVER = UINT8_MAX, END_SOON_MS = 300 };

static int poll_both(struct libcamera_events *e)
{
	const int sources[2] = {e->done[0], e->dev};
	struct epoll_event event = {.events = EPOLLIN};

	for (int i = 0; i < 2; i++)
		if (epoll_ctl(e->descriptor, EPOLL_CTL_ADD, sources[i], &event))
			return -errno;
	return 0;
}

int libcamera_events_open(struct libcamera_events *e, struct fault *fault)
{
	int err = 0;

	*e = (struct libcamera_events){.descriptor = -1, .done = {-1, -1}, .dev = -1};
	e->descriptor = epoll_create1(EPOLL_CLOEXEC);
	if (e->descriptor < 0 || pipe2(e->done, O_CLOEXEC | O_NONBLOCK))
		err = -errno;
	if (!err) {
		e->dev = inotify_init1(IN_CLOEXEC | IN_NONBLOCK);
		err = e->dev < 0 ? -errno : poll_both(e);
	}
	if (!err)
		return 0;
	libcamera_events_close(e);
	return fault_say(fault, err, "no event descriptor: %s", strerror(-err));
}

static void close_one(int *fd)
{
	if (*fd >= 0)
		close(*fd);
	*fd = -1;
}

void libcamera_events_close(struct libcamera_events *e)
{
	close_one(&e->descriptor);
	close_one(&e->done[0]);
	close_one(&e->done[1]);
	close_one(&e->dev);
}

/* Returns N of "videoN", or -1. */
static int node_number(const char *name)
{
	unsigned number;
	char rest;

	return sscanf(name, "video%u%c", &number, &rest) == 1 && number < LIBCAMERA_NODES_MAX
		       ? (int)number
		       : -1;
}

int libcamera_events_watch(struct libcamera_events *e,
			   bool (*own)(const void *context, dev_t number), const void *context,
			   struct fault *fault)
{
	static const char dev[] = "/dev/";
	struct stat status;
	glob_t found;

	if (inotify_add_watch(e->dev, dev, IN_DELETE | IN_ONLYDIR) < 0)
		return fault_say(fault, -errno, "cannot watch /dev: %s", strerror(errno));
	if (glob("/dev/video*", 0, NULL, &found))
		return 0;
	for (size_t i = 0; i < found.gl_pathc; i++) {
		const int number = node_number(found.gl_pathv[i] + strlen(dev));

		if (number >= 0 && stat(found.gl_pathv[i], &status) == 0)
			e->nodes[number] = own(context, status.st_rdev);
	}
	globfree(&found);
	return 0;
}

/* Never blocks: the pipe holds at least a page of bytes, and each request is in it at most once. */
static void events_put(struct libcamera_events *e, uint8_t byte)
{
	while (write(e->done[1], &byte, 1) < 0 && errno == EINTR)
		;
}

void libcamera_events_done(struct libcamera_events *e, int request)
{
	events_put(e, (uint8_t)request);
}

void libcamera_events_end(struct libcamera_events *e)
{
	events_put(e, OVER);
}

int libcamera_events_take(struct libcamera_events *e)
{
	uint8_t byte = OVER;

	if (!e->over && read(e->done[0], &byte, 1) != 1)
		return -EAGAIN;
	e->over = byte == OVER;
	return e->over ? -ENODEV : byte;
}

bool libcamera_events_deleted(struct libcamera_events *e)
{
	alignas(struct inotify_event) char events[4096];
	ssize_t length;

	while ((length = read(e->dev, events, sizeof(events))) > 0)
		for (const char *at = events; at < events + length;) {
			const struct inotify_event *event = (const void *)at;
			const int number = event->len > 0 ? node_number(event->name) : -1;

			e->gone = e->gone || (number >= 0 && e->nodes[number]);
			at += sizeof(*event) + event->len;
		}
	return e->gone;
}

bool libcamera_events_end_soon(struct libcamera_events *e)
{
	const int64_t until_ns = clock_now_ns() + END_SOON_MS * NS_PER_MS;
	struct pollfd done = {.fd = e->done[0], .events = POLLIN};
	int got;

	do {
		const int64_t left_ns = until_ns - clock_now_ns();

		(void)poll(&done, 1, left_ns > 0 ? (int)(left_ns / NS_PER_MS) + 1 : 0);
		while ((got = libcamera_events_take(e)) >= 0)
			;
	} while (got == -EAGAIN && clock_now_ns() < until_ns);
	return got == -ENODEV;
}
