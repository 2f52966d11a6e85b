/* SPDX-License-Identifier: MIT */
/* What libcamera's manager offers differs between its versions. */
#include "drivers/libcamera/manager.hpp"

#include <algorithm>
#include <deque>
#include <mutex>

#include "drivers/libcamera/failure.hpp"
#include "drivers/libcamera/log_stream.hpp"

extern "C" {
#include "drivers/libcamera/find.h"
#include "drivers/libcamera/hotplug.h"
#include "hal/base/log.h"
}

namespace libcamera_driver
{

namespace
{

/* libcamera aborts if a process has two managers at once, so all Managers share this one. The
 * pointer is a plain one, so that nothing is destroyed at exit: see Session::end(). */
struct Shared {
	std::mutex lock;
	lc::CameraManager *manager; /* valid while there are users */
	int users;
	unsigned kept; /* libcamera_hotplug_kept() when the manager started */
	bool outdated; /* see Manager::is_outdated() */
};

Shared shared;

} // namespace

Manager::Manager()
{
	const std::lock_guard<std::mutex> guard(shared.lock);

	if (shared.users > 0 && shared.outdated)
		throw Failure(-ENODEV, "it is about to begin anew");
	if (shared.users == 0) {
		redirect_messages();
		shared.outdated = false;
		shared.kept = libcamera_hotplug_kept();
		shared.manager = new lc::CameraManager;
		if (const int err = shared.manager->start(); err) {
			delete shared.manager;
			throw Failure(err, "it finds no devices at all", CAMERA_NO_DEVICE);
		}
	}
	shared.users++;
}

Manager::~Manager()
{
	const std::lock_guard<std::mutex> guard(shared.lock);

	if (--shared.users > 0)
		return;
	delete shared.manager; /* stops it */
}

std::vector<std::shared_ptr<lc::Camera>> Manager::cameras() const
{
	return shared.manager->cameras();
}

std::shared_ptr<lc::Camera> Manager::find(const char *wanted) const
{
	const auto all = cameras();
	std::deque<std::string> models;
	std::vector<libcamera_name> names;
	fault why;

	for (const auto &device : all)
		names.push_back(
			{device->id().c_str(), models.emplace_back(model_of(*device)).c_str()});
	const int index = libcamera_find(names.data(), (int)names.size(), wanted, &why);

	if (index < 0) {
		want_others();
		throw Failure(index, why.text);
	}
	return all[(size_t)index];
}

/* Marks the manager as outdated if the wanted camera may be among the devices that came since. */
void Manager::want_others() const
{
	const std::lock_guard<std::mutex> guard(shared.lock);

	if (shared.outdated || shared.users == 1 || shared.kept == libcamera_hotplug_kept())
		return;
	shared.outdated = true;
	log_info("libcamera: it begins anew, as devices were plugged in");
}

bool Manager::is_outdated() const
{
	const std::lock_guard<std::mutex> guard(shared.lock);

	return shared.outdated;
}

/* removeCamera() must run on libcamera's own thread. Later versions do not have it. */
void Manager::forget(const std::shared_ptr<lc::Camera> &camera) const
{
#if LIBCAMERA_AT_LEAST(0, 4)
	(void)camera;
#else
	class Errand : public lc::Object
	{
	      public:
		void run(std::shared_ptr<lc::Camera> what)
		{
			shared.manager->removeCamera(what);
		}
	};
	Errand errand;

	errand.moveToThread(camera->thread());
	errand.invokeMethod(&Errand::run, lc::ConnectionTypeBlocking, camera);
#endif
}

bool Manager::made_of(const std::shared_ptr<lc::Camera> &camera, dev_t number) const
{
#if LIBCAMERA_AT_LEAST(0, 4)
	const auto numbers = camera->properties().get(lc::properties::SystemDevices);

	return numbers &&
	       std::find(numbers->begin(), numbers->end(), (int64_t)number) != numbers->end();
#else
	return shared.manager->get(number) == camera;
#endif
}

std::string model_of(const lc::Camera &device)
{
	const auto model = device.properties().get(lc::properties::Model);

	return model ? std::string(*model) : std::string();
}

} // namespace libcamera_driver
