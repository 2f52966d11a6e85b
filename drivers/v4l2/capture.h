/* SPDX-License-Identifier: MIT */
/* A V4L2 camera that streams, and what it delivers: buffers to pictures, two where each field has
 * one. Private to camera_v4l2.c and capture.c. */
#ifndef INLAY_DRIVERS_V4L2_CAPTURE_H
#define INLAY_DRIVERS_V4L2_CAPTURE_H

#include <stdbool.h>
#include <stdint.h>

#include "drivers/v4l2/buffers.h"
#include "drivers/v4l2/controls.h"
#include "drivers/v4l2/device.h"
#include "drivers/v4l2/fields.h"
#include "drivers/v4l2/formats.h"
#include "drivers/v4l2/setup.h"
#include "hal/device/camera.h"

/* A picture that came: one buffer, or two that hold a field each. */
struct v4l2_taken {
	struct frame frame; /* PIXEL_NONE: nothing fit to be handed out */
	int buffers[2];	    /* -1: none */
};

struct v4l2_capture {
	int fd, events; /* events: an epoll of fd; -1: fd is enough */
	char path[INI_PATH_MAX];
	struct v4l2_source source;
	struct v4l2_picture picture;
	struct v4l2_buffers buffers;
	struct v4l2_settings controls;
	struct v4l2_pairing pairing;
	struct v4l2_taken waiting; /* the first field of a pair */
	struct v4l2_taken out;	   /* handed out */
	struct frame_count count;
	int64_t signal_checked_ns;
};

extern const struct v4l2_taken v4l2_nothing;

/* One buffer from the driver; an unfit one, or a first field, leaves nothing. What taking and
 * queueing a buffer give. */
int v4l2_take(struct camera *camera, struct v4l2_capture *v, struct v4l2_taken *t);

/* Its buffers are the driver's again, and nothing is left of it. The first error of queueing. */
int v4l2_give_back(struct v4l2_capture *v, struct v4l2_taken *t);

#endif
