/* SPDX-License-Identifier: MIT */
/* libcamera allocates the buffers; each is mapped once and read in place. */
#include "drivers/libcamera/driver.hpp"

#include <cerrno>
#include <utility>

extern "C" {
#include "drivers/libcamera/parts.h"
}

namespace libcamera_driver
{

Slots::~Slots()
{
	clear();
}

void Slots::make(const std::shared_ptr<lc::Camera> &device, const lc::StreamConfiguration &stream,
		 const frame &common)
{
	blank = common;
	allocator = std::make_unique<lc::FrameBufferAllocator>(device);
	if (const int got = allocator->allocate(stream.stream()); got < 2)
		throw refusal(got < 0 ? got : -ENOMEM, "cannot allocate two buffers");
	for (const auto &buffer : allocator->buffers(stream.stream())) {
		if (slots.size() == LIBCAMERA_REQUESTS_MAX)
			break;
		auto request = device->createRequest(slots.size());

		if (!request || request->addBuffer(stream.stream(), buffer.get()))
			throw refusal(-ENOMEM, "cannot make a request");
		slots.push_back({std::move(request), buffer.get(), {}, {}});
		map(slots.back(), stream);
	}
}

void Slots::map(Slot &slot, const lc::StreamConfiguration &stream) const
{
	libcamera_span spans[FRAME_PLANES];
	int count = 0;

	for (const auto &plane : slot.buffer->planes())
		if (count < FRAME_PLANES)
			spans[count++] = {plane.fd.get(),
					  plane.offset == lc::FrameBuffer::Plane::kInvalidOffset
						  ? 0
						  : plane.offset,
					  plane.length};
	slot.picture.format = blank.format;
	slot.picture.width = blank.width;
	slot.picture.height = blank.height;
	const int err = libcamera_picture_map(&slot.picture, stream.stride, spans, count);

	if (err == -EINVAL)
		throw Failure(err,
			      "its buffers are smaller than a picture of " + stream.toString());
	if (err)
		throw refusal(err, "cannot map a buffer");
}

void Slots::unmap()
{
	for (Slot &slot : slots)
		libcamera_picture_unmap(&slot.picture);
}

void Slots::clear()
{
	unmap();
	slots.clear();
	allocator.reset();
}

size_t Slots::count() const
{
	return slots.size();
}

Slot &Slots::operator[](size_t index)
{
	return slots[index];
}

bool Slots::read(const Slot &slot, frame *frame) const
{
	const lc::FrameMetadata &metadata = slot.buffer->metadata();
	const auto stamp = slot.request->metadata().get(lc::controls::SensorTimestamp);
	size_t used[FRAME_PLANES];
	int count = 0;

	if (slot.request->status() != lc::Request::RequestComplete ||
	    metadata.status == lc::FrameMetadata::FrameError ||
	    metadata.status == lc::FrameMetadata::FrameCancelled)
		return false;
	*frame = blank;
	frame->timestamp_ns = libcamera_picture_time_ns(stamp ? *stamp
							      : (int64_t)metadata.timestamp);
	frame->sequence = metadata.sequence;
	frame->buffer = (int)slot.request->cookie();
	for (const auto &plane : metadata.planes())
		if (count < FRAME_PLANES)
			used[count++] = plane.bytesused;
	return libcamera_picture_planes(&slot.picture, used, count, frame->planes);
}

} // namespace libcamera_driver
