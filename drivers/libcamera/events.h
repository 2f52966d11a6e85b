/* SPDX-License-Identifier: MIT */
/*
 * What a running camera has to tell our thread, behind one descriptor: requests that libcamera's
 * thread has done, and that the camera has gone.
 */
#ifndef INLAY_DRIVERS_LIBCAMERA_EVENTS_H
#define INLAY_DRIVERS_LIBCAMERA_EVENTS_H

#include <stdbool.h>
#include <sys/types.h>

#include "hal/base/fault.h"

enum { LIBCAMERA_REQUESTS_MAX = 64, LIBCAMERA_NODES_MAX = 256 };

struct libcamera_events {
	int descriptor;			 /* polls readable when there is something */
	int done[2];			 /* a pipe: one byte a request that is done */
	int dev;			 /* watches /dev */
	bool nodes[LIBCAMERA_NODES_MAX]; /* the camera is made of /dev/videoN */
	bool over, gone;
};

/* All or nothing: on failure there is nothing to close. */
int libcamera_events_open(struct libcamera_events *events, struct fault *fault);
void libcamera_events_close(struct libcamera_events *events);

/* Watches the video nodes that are the camera's own, by their device numbers: of cameras other than
 * webcams libcamera does not tell that they are gone. */
int libcamera_events_watch(struct libcamera_events *events,
			   bool (*own)(const void *context, dev_t number), const void *context,
			   struct fault *fault);

/* Any thread: a request, 0..LIBCAMERA_REQUESTS_MAX-1, is done; nothing more will come. */
void libcamera_events_done(struct libcamera_events *events, int request);
void libcamera_events_end(struct libcamera_events *events);

/* The request that was done first of those not yet taken; -EAGAIN: none now; -ENODEV: there will be
 * none any more. */
int libcamera_events_take(struct libcamera_events *events);

/* One of the nodes has been deleted since they are watched. */
bool libcamera_events_deleted(struct libcamera_events *events);

/* Whether the end comes within 300 ms: libcamera hears of a device that is gone a little later than
 * we do, if at all. Requests that are done meanwhile are lost. */
bool libcamera_events_end_soon(struct libcamera_events *events);

#endif
