/* SPDX-License-Identifier: MIT */
/* Lists formats, inputs and controls of V4L2 cameras as lines for people. */
#ifndef INLAY_DRIVERS_V4L2_LISTING_H
#define INLAY_DRIVERS_V4L2_LISTING_H

#include "hal/device/camera.h"

/* camera_ops.list of V4L2: calls found() for each camera and returns their number. */
int v4l2_list(void (*found)(void *context, const struct camera_listing *listing), void *context);

#endif
