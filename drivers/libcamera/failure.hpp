/* SPDX-License-Identifier: MIT */
/* Inside the driver a failure is an exception that says what the screen is to say. */
#ifndef INLAY_DRIVERS_LIBCAMERA_FAILURE_HPP
#define INLAY_DRIVERS_LIBCAMERA_FAILURE_HPP

#include <stdexcept>
#include <string>

extern "C" {
#include "hal/device/camera.h"
}

namespace libcamera_driver
{

class Failure : public std::runtime_error
{
      public:
	/* Without a situation: the one that code mostly means. */
	Failure(int code, const std::string &text);
	Failure(int code, const std::string &text, camera_situation what);

	const int err; /* negative errno */
	const camera_situation situation;
};

/* libcamera said err to what was tried. */
Failure refusal(int err, const std::string &tried);

} // namespace libcamera_driver

#endif
