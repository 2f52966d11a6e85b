/* SPDX-License-Identifier: MIT */
/* The buffers that a V4L2 device and the program exchange: memory mapped streaming. */
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
	unsigned type;	   /* V4L2_BUF_TYPE_VIDEO_CAPTURE or _MPLANE */
	int memory_planes; /* separate mappings for one buffer, 1 or 2 */
	int count;	   /* buffers */
	bool streaming;
	struct v4l2_mapping mappings[V4L2_BUFFERS_MAX][V4L2_PLANES_MAX];
};

bool v4l2_multiplanar(const struct v4l2_buffers *buffers);

/* Whether the device is free. fd and type are set; nothing is started. 0; -EBUSY: another program
 * has buffers of the device, so its settings must not be changed. */
int v4l2_buffers_try(const struct v4l2_buffers *buffers, struct fault *fault);

/* Requests and maps buffers, queues all of them and starts streaming. fd, type and memory_planes
 * are set. After a failure no buffer is left, so that the format can be set again. */
int v4l2_buffers_start(struct v4l2_buffers *buffers, int wanted, struct fault *fault);

/* Stops streaming and frees the buffers. Idempotent; accepts a zeroed struct. */
void v4l2_buffers_stop(struct v4l2_buffers *buffers);

/* Gives a buffer back to the device. 0 or -errno. */
int v4l2_buffers_queue(const struct v4l2_buffers *buffers, int index);

/* Takes the next filled buffer. planes must outlive buffer. 0; -EAGAIN: none yet; other -errno. */
int v4l2_buffers_take(const struct v4l2_buffers *buffers, struct v4l2_buffer *buffer,
		      struct v4l2_plane planes[VIDEO_MAX_PLANES]);

#endif
