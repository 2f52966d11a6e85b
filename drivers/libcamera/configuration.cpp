/* SPDX-License-Identifier: MIT */
/*
 * libcamera adjusts what it is asked for, so formats are tried until one comes back unchanged. It
 * names formats as DRM does, from the most significant byte of a word; inlay names them in the
 * order of bytes in memory.
 */
#include "drivers/libcamera/driver.hpp"

#include <algorithm>
#include <cerrno>
#include <string>

extern "C" {
#include "hal/base/log.h"
#include "hal/device/camera.h"
}

namespace libcamera_driver
{

namespace
{

/* Where two map to one format, the first is preferred. */
const Layout layouts[] = {
	{lc::formats::XRGB8888, PIXEL_BGRX}, {lc::formats::ARGB8888, PIXEL_BGRX},
	{lc::formats::RGB888, PIXEL_BGR24},  {lc::formats::BGR888, PIXEL_RGB24},
	{lc::formats::YUYV, PIXEL_YUYV},     {lc::formats::UYVY, PIXEL_UYVY},
	{lc::formats::YVYU, PIXEL_YVYU},     {lc::formats::NV16, PIXEL_NV16},
	{lc::formats::NV12, PIXEL_NV12},     {lc::formats::NV21, PIXEL_NV21},
	{lc::formats::YUV420, PIXEL_YU12},   {lc::formats::YVU420, PIXEL_YV12},
	{lc::formats::MJPEG, PIXEL_MJPEG},   {lc::formats::R8, PIXEL_GREY},
};

bool offers_size(const lc::StreamFormats &formats, const lc::PixelFormat &format, lc::Size size)
{
	const auto sizes = formats.sizes(format);

	if (is_range(formats.range(format)))
		return formats.range(format).contains(size);
	return std::find(sizes.begin(), sizes.end(), size) != sizes.end();
}

std::string offered_text(const lc::StreamFormats &formats)
{
	std::string text;

	for (const lc::PixelFormat &format : formats.pixelformats())
		text += (text.empty() ? "" : " ") + format.toString();
	return text.empty() ? "none" : text;
}

/* Asks for a format. False: the camera does not accept it. */
bool takes(lc::CameraConfiguration &configuration, const lc::PixelFormat &format, lc::Size size,
	   int buffers)
{
	lc::StreamConfiguration &stream = configuration.at(0);

	stream.pixelFormat = format;
	stream.size = size;
	stream.stride = 0;
	stream.bufferCount = (unsigned)buffers;
	return configuration.validate() != lc::CameraConfiguration::Invalid &&
	       stream.pixelFormat == format;
}

colour_matrix matrix_of(const lc::StreamConfiguration &stream, int wanted)
{
	if (wanted)
		return (colour_matrix)(wanted - 1);
	if (!stream.colorSpace ||
	    stream.colorSpace->ycbcrEncoding == lc::ColorSpace::YcbcrEncoding::None)
		return stream.size.height >= 720 ? MATRIX_BT709 : MATRIX_BT601;
	/* BT.2020, which inlay does not decode, is nearest to BT.709. */
	return stream.colorSpace->ycbcrEncoding == lc::ColorSpace::YcbcrEncoding::Rec601
		       ? MATRIX_BT601
		       : MATRIX_BT709;
}

colour_range range_of(const lc::StreamConfiguration &stream, int wanted)
{
	if (wanted)
		return (colour_range)(wanted - 1);
	/* R'G'B' and grey; libcamera has R'G'B' of full range only. */
	if (!pixel_format_is_ycbcr(format_of(stream.pixelFormat)))
		return RANGE_FULL;
	return stream.colorSpace && stream.colorSpace->range == lc::ColorSpace::Range::Full
		       ? RANGE_FULL
		       : RANGE_LIMITED;
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

std::unique_ptr<lc::CameraConfiguration> proposal(lc::Camera &device)
{
	auto configuration = device.generateConfiguration({lc::StreamRole::Viewfinder});

	if (!configuration || configuration->empty())
		return nullptr;
	return configuration;
}

std::unique_ptr<lc::CameraConfiguration> configure(lc::Camera &device,
						   const camera_settings &settings)
{
	auto configuration = proposal(device);

	if (!configuration)
		throw Failure(-ENOTSUP, "it offers no stream", CAMERA_UNSUPPORTED_FORMAT);
	const lc::StreamConfiguration &stream = configuration->at(0);
	const lc::StreamFormats formats = stream.formats();
	const lc::Size size(settings.width ? (unsigned)settings.width : stream.size.width,
			    settings.height ? (unsigned)settings.height : stream.size.height);

	for (const Layout &layout : candidates(formats, settings.format, size)) {
		if (!takes(*configuration, layout.theirs, size, settings.buffers))
			continue;
		if (settings.width && settings.height && stream.size != size)
			log_info_paced("libcamera: %s: asked for %dx%d, it gives %ux%u",
				       device.id().c_str(), settings.width, settings.height,
				       stream.size.width, stream.size.height);
		if (const int err = device.configure(configuration.get()); err)
			throw refusal(err, "cannot set " + stream.toString());
		return configuration;
	}
	throw Failure(-ENOTSUP,
		      "it offers " + offered_text(formats) + ", expected " +
			      (settings.format ? pixel_format_names[settings.format]
					       : "a format that inlay decodes"),
		      CAMERA_UNSUPPORTED_FORMAT);
}

frame blank_frame(const lc::StreamConfiguration &stream, const camera_settings &settings)
{
	frame blank = {};

	blank.format = format_of(stream.pixelFormat);
	blank.width = (int)stream.size.width;
	blank.height = (int)stream.size.height;
	blank.matrix = matrix_of(stream, settings.matrix);
	blank.range = range_of(stream, settings.range);
	return blank;
}

} // namespace libcamera_driver
