/* SPDX-License-Identifier: MIT */
/* libcamera itself: its headers, its short name here, which version it is. */
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
