/* SPDX-License-Identifier: MIT */
/* Chooses a camera's format and size, and describes the pictures that result. */
#ifndef INLAY_DRIVERS_LIBCAMERA_CONFIGURATION_HPP
#define INLAY_DRIVERS_LIBCAMERA_CONFIGURATION_HPP

#include <memory>
#include <vector>

#include "drivers/libcamera/library.hpp"

extern "C" {
#include "hal/device/camera.h"
#include "hal/frame/frame.h"
}

namespace libcamera_driver
{

struct Layout {
	lc::PixelFormat theirs; /* libcamera's */
	pixel_format ours;	/* inlay's */
};

/* Translates a format of libcamera's. PIXEL_NONE: inlay does not decode it. */
pixel_format format_of(const lc::PixelFormat &theirs);

/* Whether the range holds more than one size. */
bool is_range(const lc::SizeRange &range);

/* Returns the formats to try, best first; only `wanted`, unless that is PIXEL_NONE. For a camera
 * that does not enumerate formats these are all that inlay decodes. */
std::vector<Layout> candidates(const lc::StreamFormats &formats, int wanted, lc::Size size);

/* Returns libcamera's proposal for a viewfinder, one stream. NULL: the camera offers none. */
std::unique_ptr<lc::CameraConfiguration> proposal(lc::Camera &device);

/* Configures the camera with the first candidate that it accepts, and returns the configuration.
 * libcamera may change the size, but not the format. Throws Failure. */
std::unique_ptr<lc::CameraConfiguration> configure(lc::Camera &device,
						   const camera_settings &settings);

/* Returns a frame with what all frames of a stream share: format, size, colours. */
frame blank_frame(const lc::StreamConfiguration &stream, const camera_settings &settings);

} // namespace libcamera_driver

#endif
