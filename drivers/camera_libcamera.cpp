/* SPDX-License-Identifier: MIT */
/*
 * Cameras behind libcamera: sensors on a board's camera connector, with the board's own image
 * processor.
 *
 * This file holds the ops and the driver's table, and is where C++ ends: libcamera/ reports
 * failures by exceptions, and every op catches all of them.
 */
#include <cerrno>
#include <exception>
#include <memory>
#include <new>
#include <utility>

#include "drivers/libcamera/driver.hpp"

extern "C" {
#include "drivers/drivers.h"
#include "hal/base/log.h"
}

namespace
{

using libcamera_driver::Failure;
using libcamera_driver::Session;

Session *session_of(const camera *camera)
{
	return static_cast<Session *>(camera->state);
}

/* Runs body and turns exceptions into a fault and -errno. The fault names the camera once its id is
 * known. camera may be NULL. */
template <typename Body> int guarded(camera *camera, fault *fault, Body body) noexcept
{
	try {
		return body();
	} catch (const Failure &why) {
		const Session *const session = camera ? session_of(camera) : nullptr;
		const char *const id = session ? session->id.c_str() : "";

		if (camera)
			camera->situation = why.situation;
		return fault_say(fault, why.err, "libcamera: %s%s%s", id, *id ? ": " : "",
				 why.what());
	} catch (const std::bad_alloc &) {
		return fault_say(fault, -ENOMEM, "libcamera: no memory");
	} catch (const std::exception &why) {
		return fault_say(fault, -EIO, "libcamera: %s", why.what());
	}
}

int libcamera_list(void (*found)(void *, const camera_listing *), void *context)
{
	fault fault = {};
	const int count = guarded(nullptr, &fault,
				  [&] { return libcamera_driver::list(found, context); });

	if (count < 0)
		log_debug("%s", fault.text);
	return count == -ENODEV ? 0 : count;
}

/* close() cleans up after a failure. */
int libcamera_open(camera *camera, fault *fault)
{
	return guarded(camera, fault, [&] {
		camera->state = new Session;
		session_of(camera)->open(camera);
		return 0;
	});
}

int libcamera_descriptor(camera *camera)
{
	return session_of(camera)->descriptor();
}

int libcamera_grab(camera *camera, frame *frame, fault *fault)
{
	return guarded(camera, fault, [&] { return session_of(camera)->grab(camera, frame); });
}

void libcamera_release(camera *camera, frame *frame)
{
	guarded(nullptr, nullptr, [&] {
		session_of(camera)->release((size_t)frame->buffer);
		return 0;
	});
}

void libcamera_close(camera *camera)
{
	std::unique_ptr<Session> session(session_of(camera));

	camera->state = nullptr;
	guarded(nullptr, nullptr, [&] {
		Session::end(std::move(session));
		return 0;
	});
}

/* Never fills in the value taken: the camera reports it only with later frames. */
int libcamera_control_change(camera *camera, const char *name, const char *value, double *,
			     fault *fault)
{
	return guarded(nullptr, fault,
		       [&] { return session_of(camera)->control(name, value, fault); });
}

} // namespace

/* In the order of struct camera_ops. The driver has no keys of its own. */
extern "C" const camera_ops camera_libcamera = {
	"libcamera",
	"libcamera: sensors on a board's camera connector, and webcams",
	nullptr,
	0,
	libcamera_list,
	libcamera_open,
	libcamera_descriptor,
	libcamera_grab,
	libcamera_release,
	libcamera_close,
	libcamera_control_change,
};
