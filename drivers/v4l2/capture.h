/* SPDX-License-Identifier: MIT */
/* A V4L2 camera that streams. Makes pictures of its buffers: one buffer for each, or two if every
 * field comes in a buffer of its own. */
#ifndef INLAY_DRIVERS_V4L2_CAPTURE_H
#define INLAY_DRIVERS_V4L2_CAPTURE_H

#include <stdbool.h>
#include <stdint.h>

#include "drivers/v4l2/buffers.h"
#include "drivers/v4l2/controls.h"
#include "drivers/v4l2/device.h"
#include "drivers/v4l2/fields.h"
#include "drivers/v4l2/formats.h"
#include "drivers/v4l2/h264.h"
#include "drivers/v4l2/setup.h"
#include "hal/device/camera.h"

/* A captured picture: one buffer, or two that hold a field each. */
struct v4l2_taken {
	struct frame frame; /* format PIXEL_NONE: there is no picture */
	int buffers[2];	    /* -1: none */
};

struct v4l2_capture {
	int fd, events; /* events: an epoll of fd; -1: the device sends no events */
	char path[INI_PATH_MAX];
	struct v4l2_source source;
	struct v4l2_picture picture;
	struct v4l2_buffers buffers;
	struct v4l2_settings controls;
	struct v4l2_pairing pairing;
	struct v4l2_taken waiting; /* the first field of a pair */
	struct h264_decoder *h264; /* NULL: the device sends something else */
	bool h264_ended;	   /* no picture until the next key frame */
	bool said_short;	   /* that a frame was too short */
	struct v4l2_taken out;	   /* handed to the caller of grab() */
	struct frame_count count;
	int64_t signal_checked_ns;
	int64_t stamp_ns; /* the driver's last time stamp; 0: none that can be */
};

extern const struct v4l2_taken v4l2_nothing;

/* Takes one buffer from the driver. *t stays empty if the buffer is damaged or is the first field
 * of a pair. 0; -EAGAIN: no buffer yet; other -errno of taking or queueing. */
int v4l2_take(struct camera *camera, struct v4l2_capture *v, struct v4l2_taken *t);

/* Queues the buffers of *t again and empties it. 0, or the first error of queueing. */
int v4l2_give_back(struct v4l2_capture *v, struct v4l2_taken *t);

#endif
