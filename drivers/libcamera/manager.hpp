/* SPDX-License-Identifier: MIT */
/* libcamera's camera manager: which cameras there are, and which one the settings mean. */
#ifndef INLAY_DRIVERS_LIBCAMERA_MANAGER_HPP
#define INLAY_DRIVERS_LIBCAMERA_MANAGER_HPP

#include <memory>
#include <string>
#include <vector>

#include <sys/types.h>

#include "drivers/libcamera/library.hpp"

namespace libcamera_driver
{

struct Library;

/* A share in libcamera's manager. A process may have only one at a time; it lives as long as there
 * are shares. It knows only the devices that were there when it started: to find another one, all
 * owners of shares must give them up. */
class Manager
{
      public:
	Manager();
	~Manager();
	Manager(const Manager &) = delete;
	Manager &operator=(const Manager &) = delete;

	std::vector<std::shared_ptr<lc::Camera>> cameras() const;

	/* Finds the camera that camera_settings.device means. Throws Failure: none, or several. */
	std::shared_ptr<lc::Camera> find(const char *wanted) const;

	/* True: give the share up, because a camera is wanted that may have come since the
	 * start. */
	bool is_outdated() const;

	/* Makes the manager forget a lost camera, so that it may return under its name: libcamera
	 * aborts if two cameras have one name. */
	void forget(const std::shared_ptr<lc::Camera> &camera) const;

	/* Whether a device number (st_rdev) belongs to this camera. */
	bool made_of(const std::shared_ptr<lc::Camera> &camera, dev_t number) const;

      private:
	void want_others() const;

	std::shared_ptr<Library> library;
};

/* Returns the camera's model; empty: not known. */
std::string model_of(const lc::Camera &device);

} // namespace libcamera_driver

#endif
