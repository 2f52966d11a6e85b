/* SPDX-License-Identifier: MIT */
/* Formats of pixels: libcamera's and ours, what a camera offers, which are worth trying. */
#ifndef INLAY_DRIVERS_LIBCAMERA_FORMATS_HPP
#define INLAY_DRIVERS_LIBCAMERA_FORMATS_HPP

#include <vector>

#include "drivers/libcamera/library.hpp"

extern "C" {
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

} // namespace libcamera_driver

#endif
