/* SPDX-License-Identifier: MIT */
/* Sets format, size, fields and rate of a V4L2 device, before buffers are requested. */
#ifndef INLAY_DRIVERS_V4L2_SETUP_H
#define INLAY_DRIVERS_V4L2_SETUP_H

#include "drivers/v4l2/formats.h"
#include "drivers/v4l2/input.h"
#include "hal/device/camera.h"

/* Chooses and sets format, size, fields and rate as near to the settings as the device can, and
 * reads back what the device really uses; *rate_hz becomes 0 if it does not tell. type is
 * V4L2_BUF_TYPE_*. 0 or -errno with a fault; after -ENOSPC *picture is what was asked for. */
int v4l2_setup_picture(int fd, unsigned type, const struct camera_settings *settings,
		       enum v4l2_field_wish wish, const struct v4l2_source *source,
		       struct v4l2_picture *picture, double *rate_hz, struct fault *fault);

#endif
