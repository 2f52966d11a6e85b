/* SPDX-License-Identifier: MIT */
/* A V4L2 capture device's file: opening and asking it. */
#ifndef INLAY_DRIVERS_V4L2_DEVICE_H
#define INLAY_DRIVERS_V4L2_DEVICE_H

#include <linux/videodev2.h>
#include <stdbool.h>

#include "hal/base/fault.h"

/* 0 or -errno; interrupted calls are made again. */
int device_ioctl(int fd, unsigned long request, void *argument);

/* The capabilities of this very node, not of the whole device. */
unsigned device_caps(const struct v4l2_capability *capability);

/* It captures pictures and streams. */
bool device_captures(unsigned caps);

/* The V4L2_BUF_TYPE_* that a capturing node takes: single-planar if it has both kinds. */
unsigned device_buffer_type(const struct v4l2_capability *capability);

/* Opens path, non-blocking. A descriptor, or -errno; -ENOTTY: not a V4L2 device, -ENODEV: one
 * that does not capture. capability may be NULL. */
int device_open(const char *path, struct v4l2_capability *capability, struct fault *fault);

#endif
