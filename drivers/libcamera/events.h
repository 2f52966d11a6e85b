/* SPDX-License-Identifier: MIT */
/*
 * Events of a running camera behind one descriptor, passed from libcamera's thread to the caller's:
 * completed requests, and the loss of the camera.
 */
#ifndef INLAY_DRIVERS_LIBCAMERA_EVENTS_H
#define INLAY_DRIVERS_LIBCAMERA_EVENTS_H

#include <stdbool.h>
#include <sys/types.h>

#include "hal/base/fault.h"

enum { LIBCAMERA_REQUESTS_MAX = 64, LIBCAMERA_NODES_MAX = 256 };

struct libcamera_events {
	int descriptor;			 /* epoll: readable when there is an event */
	int done[2];			 /* pipe: one byte for each completed request */
	int dev;			 /* inotify: watches /dev */
	bool nodes[LIBCAMERA_NODES_MAX]; /* whether /dev/videoN belongs to the camera */
	bool over, gone;		 /* no more requests will complete; a node was deleted */
};

/* 0 or -errno. After a failure there is nothing to close. */
int libcamera_events_open(struct libcamera_events *events, struct fault *fault);
void libcamera_events_close(struct libcamera_events *events);

/* Watches the video nodes of the camera: libcamera reports the loss of webcams only. own() says
 * whether a device number belongs to the camera. */
int libcamera_events_watch(struct libcamera_events *events,
			   bool (*own)(const void *context, dev_t number), const void *context,
			   struct fault *fault);

/* Any thread may call these: a request, 0..LIBCAMERA_REQUESTS_MAX-1, is completed; no more will
 * be. */
void libcamera_events_done(struct libcamera_events *events, int request);
void libcamera_events_end(struct libcamera_events *events);

/* Takes the oldest completed request and returns its index. -EAGAIN: none now; -ENODEV: no more
 * will come. */
int libcamera_events_take(struct libcamera_events *events);

/* Whether a watched node has been deleted. */
bool libcamera_events_deleted(struct libcamera_events *events);

/* Waits up to 300 ms for libcamera_events_end(): libcamera learns of a lost device later than
 * inotify does, or never. Returns whether it came. Requests that complete meanwhile are lost. */
bool libcamera_events_end_soon(struct libcamera_events *events);

#endif
