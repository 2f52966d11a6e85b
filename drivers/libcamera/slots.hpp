/* SPDX-License-Identifier: MIT */
/* A camera's buffers, each with the request that it goes around with, and the pictures in them. */
#ifndef INLAY_DRIVERS_LIBCAMERA_SLOTS_HPP
#define INLAY_DRIVERS_LIBCAMERA_SLOTS_HPP

#include <deque>
#include <memory>

#include "drivers/libcamera/failure.hpp"
#include "drivers/libcamera/library.hpp"

extern "C" {
#include "drivers/libcamera/controls.h"
#include "drivers/libcamera/picture.h"
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

	/* Once the camera is configured; what cannot be is a Failure. blank: what all frames have
	 * in common. */
	void make(const std::shared_ptr<lc::Camera> &device, const lc::StreamConfiguration &stream,
		  const frame &blank);

	/* Idempotent, both: the memory alone; all of it, before the camera is released. */
	void unmap();
	void clear();

	size_t count() const;
	Slot &operator[](size_t index);

	/* The frame in a slot whose request is done. False: cancelled, damaged, or not a whole
	 * picture. */
	bool read(const Slot &slot, frame *frame) const;

      private:
	void map(Slot &slot, const lc::StreamConfiguration &stream) const;

	std::unique_ptr<lc::FrameBufferAllocator> allocator;
	std::deque<Slot> slots;
	frame blank = {};
};

} // namespace libcamera_driver

#endif
