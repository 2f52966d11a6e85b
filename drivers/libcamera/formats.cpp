/* SPDX-License-Identifier: MIT */
/* libcamera names formats as DRM does, from the most significant byte of a word; we name them in
 * the order of memory. */
#include "drivers/libcamera/formats.hpp"

#include <algorithm>

extern "C" {
#include "hal/device/camera_choice.h"
}

namespace libcamera_driver
{

namespace
{

/* Of two for one format the first is taken. */
const Layout layouts[] = {
	{lc::formats::XRGB8888, PIXEL_BGRX}, {lc::formats::ARGB8888, PIXEL_BGRX},
	{lc::formats::RGB888, PIXEL_BGR24},  {lc::formats::BGR888, PIXEL_RGB24},
	{lc::formats::YUYV, PIXEL_YUYV},     {lc::formats::UYVY, PIXEL_UYVY},
	{lc::formats::NV12, PIXEL_NV12},     {lc::formats::MJPEG, PIXEL_MJPEG},
	{lc::formats::R8, PIXEL_GREY},
};

bool offers_size(const lc::StreamFormats &formats, const lc::PixelFormat &format, lc::Size size)
{
	const auto sizes = formats.sizes(format);

	if (is_range(formats.range(format)))
		return formats.range(format).contains(size);
	return std::find(sizes.begin(), sizes.end(), size) != sizes.end();
}

} // namespace

pixel_format format_of(const lc::PixelFormat &theirs)
{
	for (const Layout &layout : layouts)
		if (layout.theirs == theirs)
			return layout.ours;
	return PIXEL_NONE;
}

bool is_range(const lc::SizeRange &range)
{
	return range.hStep > 0 && range.vStep > 0 && range.min != range.max;
}

std::vector<Layout> candidates(const lc::StreamFormats &formats, int wanted, lc::Size size)
{
	const auto offered = formats.pixelformats();
	std::vector<Layout> found;

	const auto merit = [&](const Layout &layout) {
		return camera_format_merit(layout.ours, offers_size(formats, layout.theirs, size),
					   false);
	};
	for (const Layout &layout : layouts)
		if ((wanted == PIXEL_NONE || layout.ours == wanted) &&
		    (offered.empty() ||
		     std::find(offered.begin(), offered.end(), layout.theirs) != offered.end()))
			found.push_back(layout);
	std::stable_sort(found.begin(), found.end(),
			 [&](const Layout &a, const Layout &b) { return merit(a) > merit(b); });
	return found;
}

} // namespace libcamera_driver
