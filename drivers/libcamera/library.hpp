/* SPDX-License-Identifier: MIT */
/* Includes libcamera, shortens its namespace to lc, and tests its version. */
#ifndef INLAY_DRIVERS_LIBCAMERA_LIBRARY_HPP
#define INLAY_DRIVERS_LIBCAMERA_LIBRARY_HPP

#include <libcamera/libcamera.h>

#define LIBCAMERA_AT_LEAST(major, minor)                                                           \
	(LIBCAMERA_VERSION_MAJOR > (major) ||                                                      \
	 (LIBCAMERA_VERSION_MAJOR == (major) && LIBCAMERA_VERSION_MINOR >= (minor)))

namespace libcamera_driver
{

namespace lc = libcamera;

} // namespace libcamera_driver

#endif
