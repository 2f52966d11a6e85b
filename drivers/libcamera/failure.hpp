/* SPDX-License-Identifier: MIT */
/* The exception of this driver. It carries the errno and the situation that the screen shows. */
#ifndef INLAY_DRIVERS_LIBCAMERA_FAILURE_HPP
#define INLAY_DRIVERS_LIBCAMERA_FAILURE_HPP

#include <cerrno>
#include <cstring>
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
	/* Uses the situation that code usually means. */
	Failure(int code, const std::string &text) : Failure(code, text, camera_situation_of(code))
	{
	}

	Failure(int code, const std::string &text, camera_situation what)
	    : std::runtime_error(text), err(code), situation(what)
	{
	}

	const int err; /* negative errno */
	const camera_situation situation;
};

/* Makes a Failure from an error of libcamera and what was tried. */
inline Failure refusal(int err, const std::string &tried)
{
	return {err, err == -ENOSPC ? "the bus has no room for its pictures: ask for a smaller "
				      "size or a lower rate"
				    : tried + ": " + strerror(-err)};
}

} // namespace libcamera_driver

#endif
