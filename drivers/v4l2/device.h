/* SPDX-License-Identifier: MIT */
/* Opens a V4L2 capture device and calls its ioctls. */
#ifndef INLAY_DRIVERS_V4L2_DEVICE_H
#define INLAY_DRIVERS_V4L2_DEVICE_H

#include <linux/videodev2.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/base/fault.h"

/* Calls ioctl() until it is not interrupted. 0 or -errno. */
int device_ioctl(int fd, unsigned long request, void *argument);

/* Returns the capabilities of this node, not of the whole device. */
unsigned device_caps(const struct v4l2_capability *capability);

/* Whether a node of these capabilities captures pictures and streams. */
bool device_captures(unsigned caps);

/* Whether the node is one of many in the pipeline of a media controller, or an image processor's.
 * It gives pictures only after another program has set the pipeline up, as libcamera does. */
bool device_is_part(const struct v4l2_capability *capability);

/* The name on a device's card, valid UTF-8. */
void device_name(const uint8_t card[32], char *name, size_t room);

/* Returns the V4L2_BUF_TYPE_* of a capturing node: single-planar if it has both kinds. */
unsigned device_buffer_type(const struct v4l2_capability *capability);

/* Opens path, non-blocking. Returns a descriptor that the caller closes, or -errno: -ENOTTY not a
 * V4L2 device, -ENODEV one that does not capture. capability may be NULL. */
int device_open(const char *path, struct v4l2_capability *capability, struct fault *fault);

#endif
