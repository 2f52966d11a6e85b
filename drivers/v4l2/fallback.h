/* SPDX-License-Identifier: MIT */
/* What to ask for instead when the bus has no room: a smaller format, a smaller size, a lower rate,
 * as far as camera_settings.give_up allows and in its order. */
#ifndef INLAY_DRIVERS_V4L2_FALLBACK_H
#define INLAY_DRIVERS_V4L2_FALLBACK_H

#include "drivers/v4l2/formats.h"
#include "hal/device/camera.h"

enum v4l2_sacrifice { V4L2_GIVE_FORMAT, V4L2_GIVE_SIZE, V4L2_GIVE_RATE, V4L2_GIVE_COUNT };

struct v4l2_fallback {
	enum v4l2_sacrifice order[V4L2_GIVE_COUNT];
	int count, next; /* order[next] is what may go now */
};

/* Reads settings.give_up. -EINVAL: a word that is none of "format", "size", "rate", or twice. */
int v4l2_fallback_read(struct v4l2_fallback *fallback, const char *give_up, struct fault *fault);

/* Lessens what settings ask for, beginning from what the device would have given. False: nothing
 * is left that may go. */
bool v4l2_fallback_step(struct v4l2_fallback *fallback, int fd, unsigned type,
			const struct v4l2_picture *picture, double rate_hz,
			struct camera_settings *settings);

/* "640x480 MJPEG at 15 Hz" */
void v4l2_describe(const struct v4l2_picture *picture, double rate_hz, char *text, size_t room);

#endif
