/* SPDX-License-Identifier: MIT */
/* What a V4L2 camera offers, as lines for people. */
#ifndef INLAY_DRIVERS_V4L2_LISTING_H
#define INLAY_DRIVERS_V4L2_LISTING_H

#include "hal/device/camera.h"

/* camera_ops.list of V4L2. */
int v4l2_list(void (*found)(void *context, const struct camera_listing *listing), void *context);

#endif
