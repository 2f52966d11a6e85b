/* SPDX-License-Identifier: MIT */
/* Two threads meet here: the caller's, and libcamera's, which only writes to events. */
#include "drivers/libcamera/driver.hpp"

#include <cerrno>
#include <cstdio>
#include <mutex>
#include <utility>

namespace libcamera_driver
{

Session::Session()
{
	fault why;

	if (const int err = libcamera_events_open(&events, &why); err)
		throw Failure(err, why.text);
}

Session::~Session()
{
	if (device) {
		/* After this libcamera's thread makes no more calls. */
		device->stop();
		device->requestCompleted.disconnect(this);
		device->disconnected.disconnect(this);
	}
	slots.clear();
	configuration.reset();
	if (acquired)
		device->release();
	libcamera_events_close(&events);
}

/*
 * libcamera aborts the program if it is asked to stop a lost camera, unless it has noticed the loss
 * itself, as it does for webcams. It also crashes if a running camera is destroyed. So the session
 * of such a camera is never deleted. Each one costs memory and about twenty descriptors and, while
 * another camera is open, a thread of libcamera's that is woken all the time. It happens only when
 * a sensor's driver is unbound under a running program.
 */
void Session::end(std::unique_ptr<Session> session)
{
	static auto *const left = new std::vector<std::unique_ptr<Session>>;
	static std::mutex lock;

	if (!session || session->can_be_deleted())
		return;
	const std::lock_guard<std::mutex> guard(lock);

	left->push_back(std::move(session));
}

bool Session::can_be_deleted()
{
	if (!libcamera_events_deleted(&events) || libcamera_events_end_soon(&events))
		return true;
	slots.unmap();
	manager->forget(device);
	manager.reset();
	return false;
}

/* ---- opening ---- */

void Session::open(camera *camera)
{
	take(camera);
	watch();
	configuration = configure(*device, camera->settings);
	const lc::StreamConfiguration &stream = configuration->at(0);
	const frame blank = blank_frame(stream, camera->settings);

	camera->format = blank.format;
	camera->width = blank.width;
	camera->height = blank.height;
	slots.make(device, stream, blank);
	controls = controls_of(device->controls());
	camera->rate_hz = libcamera_wishes_read(&wishes, id.c_str(), controls.data(),
						(int)controls.size(), camera->settings.controls,
						camera->settings.rate_hz);
	start();
}

/* Finds the camera and acquires it: no other process can use it then. */
void Session::take(camera *camera)
{
	device = manager->find(camera->settings.device);
	id = device->id();
	const std::string model = model_of(*device);

	snprintf(camera->name, sizeof(camera->name), "%s", (model.empty() ? id : model).c_str());
	if (const int err = device->acquire(); err)
		throw refusal(err, "cannot take the camera, another program may use it");
	acquired = true;
}

void Session::watch()
{
	const auto own = [](const void *session, dev_t number) {
		const auto *const self = static_cast<const Session *>(session);

		return self->manager->made_of(self->device, number);
	};
	fault why;

	if (const int err = libcamera_events_watch(&events, own, this, &why); err)
		throw Failure(err, why.text);
}

/* The functions that are connected here run on libcamera's thread. */
void Session::start()
{
	device->requestCompleted.connect(this, [this](lc::Request *request) {
		libcamera_events_done(&events, (int)request->cookie());
	});
	device->disconnected.connect(this, [this] { libcamera_events_end(&events); });
	if (const int err = device->start(); err)
		throw refusal(err, "cannot start the camera");
	for (size_t i = 0; i < slots.count(); i++)
		queue(slots[i]);
}

/* ---- streaming ---- */

int Session::descriptor() const
{
	return events.descriptor;
}

int Session::grab(camera *camera, frame *frame)
{
	::frame newest = {};
	int index = -EAGAIN;

	if (libcamera_events_deleted(&events))
		throw Failure(-ENODEV, "the camera has gone");
	if (manager->is_outdated())
		throw Failure(-ESTALE, "libcamera begins anew", CAMERA_FINE);
	/* At most once for each slot, however fast the camera is. */
	for (size_t i = 0; i < slots.count(); i++) {
		index = libcamera_events_take(&events);
		if (index < 0)
			break;
		accept(slots[(size_t)index], camera, &newest);
	}
	if (index == -ENODEV)
		throw why_over();
	if (newest.format == PIXEL_NONE)
		return -EAGAIN;
	libcamera_picture_reading(&slots[(size_t)newest.buffer].picture, true);
	*frame = newest;
	return 0;
}

/* Takes a completed request: a whole picture becomes the newest frame, any other is requeued. */
void Session::accept(Slot &slot, camera *camera, frame *newest)
{
	frame next;

	if (!slots.read(slot, &next)) {
		camera->broken++;
		libcamera_wishes_refused(&wishes, slot.load);
		requeue(slot);
		return;
	}
	camera->lost += frame_count_gap(&count, next.sequence);
	read_metadata(camera, slot.request->metadata());
	if (newest->format != PIXEL_NONE) {
		camera->lost++;
		requeue(slots[(size_t)newest->buffer]);
	}
	*newest = next;
}

Failure Session::why_over() const
{
	return trouble && trouble != -ENODEV ? refusal(trouble, "it takes no request")
					     : Failure(-ENODEV, "the camera has gone");
}

void Session::read_metadata(camera *camera, const lc::ControlList &metadata)
{
	const auto duration_us = metadata.get(lc::controls::FrameDuration);

	if (duration_us && *duration_us > 0)
		camera->rate_hz = 1e6 / (double)*duration_us;
	libcamera_wishes_compare(&wishes, used_value, &metadata);
}

void Session::release(size_t index)
{
	libcamera_picture_reading(&slots[index].picture, false);
	requeue(slots[index]);
}

void Session::requeue(Slot &slot)
{
	slot.request->reuse(lc::Request::ReuseBuffers);
	queue(slot);
}

/* A failure is reported by the next grab(). */
void Session::queue(Slot &slot)
{
	slot.load = put_wishes(wishes, slot.request->controls());
	if (const int err = device->queueRequest(slot.request.get()); err) {
		trouble = err;
		libcamera_events_end(&events);
	}
}

int Session::control(const char *name, const char *value, fault *fault)
{
	::fault why;

	if (const int err = libcamera_wishes_change(&wishes, controls.data(), (int)controls.size(),
						    name, value, &why);
	    err)
		return fault_say(fault, err, "libcamera: %s: %s", id.c_str(), why.text);
	return 0;
}

} // namespace libcamera_driver
