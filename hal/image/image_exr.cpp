/* SPDX-License-Identifier: MIT */
/*
 * OpenEXR: the first part of a file, in scan lines or tiles, channels R, G, B or Y alone, half or
 * float. Alpha and other channels are ignored. The picture is the display window; the data window
 * of a file may be smaller (cropped) or larger (overscan).
 *
 * This file is C++, because the C interface (OpenEXRCore 3.1) cannot read the DWA compressions,
 * which many panoramas use, and writes to channels that were not requested.
 */
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <exception>
#include <new>
#include <stdexcept>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfStandardAttributes.h>

extern "C" {
#include "hal/image/codec.h"
}

namespace
{

class MemoryStream : public Imf::IStream
{
      public:
	explicit MemoryStream(const image_source &file) : Imf::IStream(file.name), source(file)
	{
	}

	bool read(char out[], int count) override
	{
		if (count < 0 || (size_t)count > source.bytes - position)
			throw std::runtime_error("the file ends too early");
		std::memcpy(out, source.data + position, (size_t)count);
		position += (size_t)count;
		return position < source.bytes;
	}

	uint64_t tellg() override
	{
		return position;
	}

	void seekg(uint64_t to) override
	{
		if (to > source.bytes)
			throw std::runtime_error("it points beyond the end of the file");
		position = (size_t)to;
	}

      private:
	const image_source &source;
	size_t position = 0;
};

/* Checks the channels; sets *grey if Y is the only one and fills all three. */
int check_channels(const image_source *source, const Imf::ChannelList &channels, bool *grey,
		   struct fault *fault)
{
	const char *const wanted[] = {"R", "G", "B", "Y"};
	unsigned found = 0;

	for (auto at = channels.begin(); at != channels.end(); ++at)
		if (at.channel().xSampling != 1 || at.channel().ySampling != 1)
			return fault_say(fault, -ENOTSUP,
					 "%s: channel %s is subsampled, expected full size",
					 source->name, at.name());
	for (unsigned i = 0; i < 4; i++) {
		const Imf::Channel *channel = channels.findChannel(wanted[i]);

		if (!channel)
			continue;
		if (channel->type == Imf::UINT)
			return fault_say(fault, -ENOTSUP,
					 "%s: channel %s is of integers, expected half or float",
					 source->name, wanted[i]);
		found |= 1U << i;
	}
	*grey = found == 8;
	if (found != 7 && found != 8)
		return fault_say(fault, -ENOTSUP, "%s: expected channels R, G and B, or Y alone",
				 source->name);
	return 0;
}

void read_pixels(Imf::InputFile &file, bool grey, struct image *image)
{
	const Imath::Box2i window = file.header().dataWindow();
	const size_t pixel = 3 * sizeof(float), row = pixel * (size_t)image->width;
	const char *const names[] = {"R", "G", "B"};
	const size_t count = (size_t)image->width * (size_t)image->height;
	Imf::FrameBuffer buffer;

	for (int c = 0; c < (grey ? 1 : 3); c++)
		buffer.insert(grey ? "Y" : names[c],
			      Imf::Slice::Make(Imf::FLOAT, image->f32 + c, window, pixel, row));
	file.setFrameBuffer(buffer);
	file.readPixels(window.min.y, window.max.y);
	for (size_t i = 0; grey && i < count; i++)
		image->f32[3 * i + 1] = image->f32[3 * i + 2] = image->f32[3 * i];
}

int check_colours(const image_source *source, const Imf::Header &header, struct fault *fault)
{
	if (!Imf::hasChromaticities(header))
		return 0;

	const Imf::Chromaticities &c = Imf::chromaticities(header);
	const double xy[8] = {c.red.x,	c.red.y,  c.green.x, c.green.y,
			      c.blue.x, c.blue.y, c.white.x, c.white.y};

	return image_check_primaries(source, xy, fault);
}

/* Copies the data window (held) into a picture of the display window (shown): pixels that the file
 * lacks are black, pixels outside the display window are dropped. */
int take_shown(const image_source *source, const Imath::Box2i &held, const Imath::Box2i &shown,
	       struct image *image, struct fault *fault)
{
	const int64_t width = (int64_t)shown.max.x - shown.min.x + 1;
	const int64_t height = (int64_t)shown.max.y - shown.min.y + 1;
	const int left = std::max(held.min.x, shown.min.x);
	const int right = std::min(held.max.x, shown.max.x);
	const size_t pixel = 3 * sizeof(float);
	struct image whole;
	int err = image_check_size(source, width, height, 3 * sizeof(float), fault);

	if (err)
		return err;
	err = image_create_f32(&whole, (int)width, (int)height);
	if (err)
		return fault_say(fault, err, "%s: not enough memory for the picture", source->name);
	for (int64_t y = std::max(held.min.y, shown.min.y);
	     y <= std::min(held.max.y, shown.max.y) && left <= right; y++) {
		const size_t from = (size_t)(y - held.min.y) * (size_t)image->width +
				    (size_t)((int64_t)left - held.min.x);
		const size_t to = (size_t)(y - shown.min.y) * (size_t)width +
				  (size_t)((int64_t)left - shown.min.x);

		std::memcpy(whole.f32 + 3 * to, image->f32 + 3 * from,
			    pixel * (size_t)((int64_t)right - left + 1));
	}
	image_free(image);
	*image = whole;
	return 0;
}

int read_file(const image_source *source, struct image *image, struct fault *fault)
{
	MemoryStream stream(*source);

	/* The library allocates memory by the header before the code below can check it. */
	Imf::Header::setMaxImageSize(IMAGE_SIDE_MAX, IMAGE_SIDE_MAX);
	Imf::Header::setMaxTileSize(IMAGE_SIDE_MAX, IMAGE_SIDE_MAX);

	Imf::InputFile file(stream, 0);
	const Imath::Box2i window = file.header().dataWindow();
	const int64_t width = (int64_t)window.max.x - window.min.x + 1;
	const int64_t height = (int64_t)window.max.y - window.min.y + 1;
	bool grey = false;
	int err = image_check_size(source, width, height, 3 * sizeof(float), fault);

	if (!err)
		err = check_channels(source, file.header().channels(), &grey, fault);
	if (!err)
		err = check_colours(source, file.header(), fault);
	if (err)
		return err;
	err = image_create_f32(image, (int)width, (int)height);
	if (err)
		return fault_say(fault, err, "%s: not enough memory for the picture", source->name);
	read_pixels(file, grey, image);
	if (file.header().displayWindow() == window)
		return 0;
	return take_shown(source, window, file.header().displayWindow(), image, fault);
}

bool exr_probe(const uint8_t *data, size_t bytes)
{
	return bytes >= 4 && data[0] == 0x76 && data[1] == 0x2f && data[2] == 0x31 &&
	       data[3] == 0x01;
}

/* Catches all exceptions: the caller is C. */
int exr_read(const image_source *source, struct image *image, struct fault *fault)
{
	try {
		return read_file(source, image, fault);
	} catch (const std::bad_alloc &) {
		return fault_say(fault, -ENOMEM, "%s: not enough memory for the picture",
				 source->name);
	} catch (const std::exception &e) {
		return fault_say(fault, -EBADMSG, "%s: damaged OpenEXR file: %s", source->name,
				 e.what());
	}
}

} // namespace

extern "C" const struct image_codec image_exr = {"OpenEXR", ".exr",   true,
						 exr_probe, exr_read, nullptr};
