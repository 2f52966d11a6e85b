/* SPDX-License-Identifier: MIT */
/* A camera's buffers, each with its request and the picture mapped in it. */
#ifndef INLAY_DRIVERS_LIBCAMERA_SLOTS_HPP
#define INLAY_DRIVERS_LIBCAMERA_SLOTS_HPP

#include <deque>
#include <memory>

#include "drivers/libcamera/failure.hpp"
#include "drivers/libcamera/library.hpp"

extern "C" {
#include "drivers/libcamera/parts.h"
#include "hal/frame/frame.h"
}

namespace libcamera_driver
{

struct Slot {
	std::unique_ptr<lc::Request> request; /* its cookie is the slot's index */
	const lc::FrameBuffer *buffer;
	libcamera_picture picture;
	libcamera_load load; /* the controls that the request carries */
};

class Slots
{
      public:
	Slots() = default;
	~Slots();
	Slots(const Slots &) = delete;
	Slots &operator=(const Slots &) = delete;

	/* Allocates the buffers of a configured camera. blank: what all frames share. Throws
	 * Failure. */
	void make(const std::shared_ptr<lc::Camera> &device, const lc::StreamConfiguration &stream,
		  const frame &blank);

	/* Both are idempotent. */
	void unmap(); /* the memory only */
	void clear(); /* everything; call it before the camera is released */

	size_t count() const;
	Slot &operator[](size_t index);

	/* Reads the frame of a slot whose request is completed. False: cancelled, damaged, or not a
	 * whole picture. */
	bool read(const Slot &slot, frame *frame) const;

      private:
	void map(Slot &slot, const lc::StreamConfiguration &stream) const;

	std::unique_ptr<lc::FrameBufferAllocator> allocator;
	std::deque<Slot> slots;
	frame blank = {};
};

} // namespace libcamera_driver

#endif
