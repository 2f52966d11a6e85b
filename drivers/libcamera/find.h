/* SPDX-License-Identifier: MIT */
/* Finds the camera that a name in the configuration means. */
#ifndef INLAY_DRIVERS_LIBCAMERA_FIND_H
#define INLAY_DRIVERS_LIBCAMERA_FIND_H

#include "hal/base/fault.h"

struct libcamera_name {
	const char *id, *model;
};

/* Finds a camera by id, else by model, else by a part of either; an empty name means the first one.
 * Returns an index, or -errno with a fault: -EINVAL more than one fits, -ENODEV none, -EACCES none
 * that this user may open. */
int libcamera_find(const struct libcamera_name *cameras, int count, const char *wanted,
		   struct fault *fault);

#endif
