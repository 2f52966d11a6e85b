/* SPDX-License-Identifier: MIT */
/* Chooses what to ask for when the bus has no room: a smaller format, a smaller size or a lower
 * rate, in the order of camera_settings.give_up and no further than it allows. */
#ifndef INLAY_DRIVERS_V4L2_FALLBACK_H
#define INLAY_DRIVERS_V4L2_FALLBACK_H

#include "drivers/v4l2/formats.h"
#include "hal/device/camera.h"

enum v4l2_sacrifice { V4L2_GIVE_FORMAT, V4L2_GIVE_SIZE, V4L2_GIVE_RATE, V4L2_GIVE_COUNT };

struct v4l2_fallback {
	enum v4l2_sacrifice order[V4L2_GIVE_COUNT];
	int count, next; /* order[next] is the sacrifice to make now */
};

/* Reads settings.give_up. 0; -EINVAL: a word other than "format", "size", "rate", or one twice. */
int v4l2_fallback_read(struct v4l2_fallback *fallback, const char *give_up, struct fault *fault);

/* Reduces the settings by one step, starting from the picture that the device had chosen. False: no
 * sacrifice is left. */
bool v4l2_fallback_step(struct v4l2_fallback *fallback, int fd, unsigned type,
			const struct v4l2_picture *picture, double rate_hz,
			struct camera_settings *settings);

/* Writes "640x480 MJPEG at 15 Hz"; a rate of 0 is left out. */
void v4l2_describe(const struct v4l2_picture *picture, double rate_hz, char *text, size_t room);

#endif
