/* SPDX-License-Identifier: MIT */
/* How a camera is set up: format and size, and what its pictures will be. */
#ifndef INLAY_DRIVERS_LIBCAMERA_CONFIGURATION_HPP
#define INLAY_DRIVERS_LIBCAMERA_CONFIGURATION_HPP

#include <memory>

#include "drivers/libcamera/library.hpp"

extern "C" {
#include "hal/device/camera.h"
}

namespace libcamera_driver
{

/* What libcamera proposes for pictures that are shown as they come: one stream. NULL: it has none.
 */
std::unique_ptr<lc::CameraConfiguration> proposal(lc::Camera &device);

/* The configuration that will be used; libcamera may answer with another size, never with another
 * format than one of the candidates. */
std::unique_ptr<lc::CameraConfiguration> configure(lc::Camera &device,
						   const camera_settings &settings);

/* What all frames of a stream have in common: format, size, colours. */
frame blank_frame(const lc::StreamConfiguration &stream, const camera_settings &settings);

} // namespace libcamera_driver

#endif
