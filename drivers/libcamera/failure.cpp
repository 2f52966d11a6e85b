/* SPDX-License-Identifier: MIT */
/* What errors of libcamera mean, in words. */
#include "drivers/libcamera/failure.hpp"

#include <cerrno>
#include <cstring>

extern "C" {
#include "hal/device/camera_situation.h"
}

namespace libcamera_driver
{

Failure::Failure(int code, const std::string &text) : Failure(code, text, camera_situation_of(code))
{
}

Failure::Failure(int code, const std::string &text, camera_situation what)
    : std::runtime_error(text), err(code), situation(what)
{
}

Failure refusal(int err, const std::string &tried)
{
	return {err, err == -ENOSPC ? "the bus has no room for its pictures: ask for a smaller "
				      "size or a lower rate"
				    : tried + ": " + strerror(-err)};
}

} // namespace libcamera_driver
