/* SPDX-License-Identifier: MIT */
/* How a camera is set up: format and size, and what its pictures will be. */
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
	lc::PixelFormat theirs;
	pixel_format ours;
};

/* PIXEL_NONE: inlay does not decode it. */
pixel_format format_of(const lc::PixelFormat &theirs);

/* Of more than one size. */
bool is_range(const lc::SizeRange &range);

/* The formats to try, best first; wanted: that one alone, or PIXEL_NONE. A camera that does not
 * tell its formats is asked for each of ours. */
std::vector<Layout> candidates(const lc::StreamFormats &formats, int wanted, lc::Size size);

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
