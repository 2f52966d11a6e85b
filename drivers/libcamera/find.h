/* SPDX-License-Identifier: MIT */
/* Which camera is meant by a name. */
#ifndef INLAY_DRIVERS_LIBCAMERA_FIND_H
#define INLAY_DRIVERS_LIBCAMERA_FIND_H

#include "hal/base/fault.h"

struct libcamera_name {
	const char *id, *model;
};

/* By id, else by model, else by a part of either; empty: the first. An index, or -EINVAL: more than
 * one; -ENODEV: none; -EACCES: none for this user. */
int libcamera_find(const struct libcamera_name *cameras, int count, const char *wanted,
		   struct fault *fault);

#endif
