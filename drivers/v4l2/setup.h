/* SPDX-License-Identifier: MIT */
/* Bringing a V4L2 device to the point where buffers can be asked for. */
#ifndef INLAY_DRIVERS_V4L2_SETUP_H
#define INLAY_DRIVERS_V4L2_SETUP_H

#include "drivers/v4l2/formats.h"
#include "drivers/v4l2/input.h"
#include "hal/device/camera.h"

/* Chooses and sets format, size, fields and rate as near to the settings as the device can, and
 * reads back what it really does; rate_hz is 0 when the device does not say. type is
 * V4L2_BUF_TYPE_*. */
int v4l2_setup_picture(int fd, unsigned type, const struct camera_settings *settings,
		       enum v4l2_field_wish wish, const struct v4l2_source *source,
		       struct v4l2_picture *picture, double *rate_hz, struct fault *fault);

#endif
