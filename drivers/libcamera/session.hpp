/* SPDX-License-Identifier: MIT */
/* A camera while it is open: requests circulate, and the newest frame is handed out. */
#ifndef INLAY_DRIVERS_LIBCAMERA_SESSION_HPP
#define INLAY_DRIVERS_LIBCAMERA_SESSION_HPP

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/libcamera/failure.hpp"
#include "drivers/libcamera/library.hpp"
#include "drivers/libcamera/manager.hpp"
#include "drivers/libcamera/slots.hpp"

extern "C" {
#include "drivers/libcamera/parts.h"
#include "hal/device/camera.h"
}

namespace libcamera_driver
{

/* The functions open() to control() are the ops of camera_ops; all but descriptor() may throw. The
 * destructor cleans up however far open() came. */
class Session
{
      public:
	Session();
	~Session();
	Session(const Session &) = delete;
	Session &operator=(const Session &) = delete;

	void open(camera *camera);
	int descriptor() const;
	int grab(camera *camera, frame *frame);
	void release(size_t index); /* frame.buffer */
	int control(const char *name, const char *value, fault *fault);

	/* Deletes the session, unless the camera is lost in a way that libcamera cannot clean up
	 * after: then it is kept for ever, but gives up its share in the manager. */
	static void end(std::unique_ptr<Session> session);

	std::string id; /* the camera's; empty until it is found */

      private:
	void take(camera *camera);
	void watch();
	void start();
	void queue(Slot &slot);
	void requeue(Slot &slot);
	void accept(Slot &slot, camera *camera, frame *newest);
	Failure why_over() const;
	void read_metadata(camera *camera, const lc::ControlList &metadata);
	bool can_be_deleted();

	std::optional<Manager> manager = std::make_optional<Manager>(); /* destroyed last */
	libcamera_events events;
	std::shared_ptr<lc::Camera> device;
	bool acquired = false;
	std::unique_ptr<lc::CameraConfiguration> configuration;
	Slots slots;
	std::vector<libcamera_control> controls;
	libcamera_wishes wishes = {};
	int trouble = 0; /* -errno of a request that libcamera refused; 0: none */
	frame_count count = {};
};

} // namespace libcamera_driver

#endif
