/* SPDX-License-Identifier: MIT */
/* libcamera's manager: which cameras there are, and which of them is meant. */
#ifndef INLAY_DRIVERS_LIBCAMERA_MANAGER_HPP
#define INLAY_DRIVERS_LIBCAMERA_MANAGER_HPP

#include <memory>
#include <string>
#include <vector>

#include <sys/types.h>

#include "drivers/libcamera/library.hpp"

namespace libcamera_driver
{

/* A process may have only one at a time: it lives as long as somebody holds one of these. It knows
 * the devices that there were when it began; for another, all who hold it let go of it. */
class Manager
{
      public:
	Manager();
	~Manager();
	Manager(const Manager &) = delete;
	Manager &operator=(const Manager &) = delete;

	std::vector<std::shared_ptr<lc::Camera>> cameras() const;

	/* By what camera_settings.device says; a Failure where that is none or more than one. */
	std::shared_ptr<lc::Camera> find(const char *wanted) const;

	/* True: let go of it. A camera is looked for that may have come since it began. */
	bool is_outdated() const;

	/* So that the camera may come back under its name: two of one name are fatal. */
	void forget(const std::shared_ptr<lc::Camera> &camera) const;

	/* The device, as in struct stat, is one that this camera is made of. */
	bool made_of(const std::shared_ptr<lc::Camera> &camera, dev_t number) const;

      private:
	void want_others() const;
};

/* Empty: not known. */
std::string model_of(const lc::Camera &device);

} // namespace libcamera_driver

#endif
