/* SPDX-License-Identifier: MIT */
/* Lists the formats and controls of cameras as lines for people. */
#ifndef INLAY_DRIVERS_LIBCAMERA_LISTING_HPP
#define INLAY_DRIVERS_LIBCAMERA_LISTING_HPP

extern "C" {
#include "hal/device/camera.h"
}

namespace libcamera_driver
{

/* camera_ops.list of libcamera. Returns the number of cameras. Throws Failure if no manager
 * starts. */
int list(void (*found)(void *context, const camera_listing *listing), void *context);

} // namespace libcamera_driver

#endif
