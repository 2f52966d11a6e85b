/* SPDX-License-Identifier: MIT */
/* The memory that a V4L2 device and the program pass to and fro. */
#ifndef INLAY_DRIVERS_V4L2_BUFFERS_H
#define INLAY_DRIVERS_V4L2_BUFFERS_H

#include <linux/videodev2.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/base/fault.h"

enum { V4L2_BUFFERS_MAX = 16, V4L2_PLANES_MAX = 2 };

struct v4l2_mapping {
	uint8_t *memory; /* NULL: not mapped */
	size_t length;
};

struct v4l2_buffers {
	int fd;
	unsigned type; /* V4L2_BUF_TYPE_VIDEO_CAPTURE or _MPLANE */
	int memory_planes;
	int count;
	bool streaming;
	struct v4l2_mapping mappings[V4L2_BUFFERS_MAX][V4L2_PLANES_MAX];
};

bool v4l2_multiplanar(const struct v4l2_buffers *buffers);

/* fd and type are set, and nothing is started. -EBUSY: another program has memory of the device, so
 * that nothing of it is to be changed; else 0. */
int v4l2_buffers_try(const struct v4l2_buffers *buffers, struct fault *fault);

/* fd, type and memory_planes are set. Asks for memory, maps it, gives all of it to the device and
 * starts it. On failure nothing is left that keeps the format from being set again. */
int v4l2_buffers_start(struct v4l2_buffers *buffers, int wanted, struct fault *fault);

/* Idempotent; zeroed is fine. */
void v4l2_buffers_stop(struct v4l2_buffers *buffers);

/* Gives a buffer back to the device. */
int v4l2_buffers_queue(const struct v4l2_buffers *buffers, int index);

/* The next one that is filled; planes must outlive buffer. -EAGAIN: none yet. */
int v4l2_buffers_take(const struct v4l2_buffers *buffers, struct v4l2_buffer *buffer,
		      struct v4l2_plane planes[VIDEO_MAX_PLANES]);

#endif
