/* SPDX-License-Identifier: MIT */
/* What libcamera's manager offers differs between its versions. */
#include "drivers/libcamera/driver.hpp"

#define LIBCAMERA_BASE_PRIVATE
#include <libcamera/base/semaphore.h>

#include <algorithm>
#include <deque>
#include <mutex>
#include <utility>

extern "C" {
#include "drivers/libcamera/parts.h"
#include "hal/base/log.h"
}

/*
 * This replaces libcamera's function of the same name, which notifies after it has unlocked. The
 * one who waits has the semaphore on its stack and may be gone by then: whoever notifies waits
 * forever in memory that is something else, and with it everybody who waits for him.
 */
void libcamera::Semaphore::release(unsigned int n)
{
	MutexLocker locker(mutex_);

	available_ += n;
	cv_.notify_all();
}

namespace libcamera_driver
{

/* What all Managers share. */
struct Library {
	const unsigned kept = libcamera_hotplug_kept(); /* when it started */
	bool outdated = false;				/* see Manager::is_outdated() */
	lc::CameraManager manager;
};

namespace
{

/* libcamera aborts if a process has two managers at once. So this one is shared, and a Manager
 * takes and gives up its share only under the lock: the next library starts after the last one
 * ended. */
std::mutex lock;
std::weak_ptr<Library> &current =
	*new std::weak_ptr<Library>; /* never destroyed: threads at exit */

} // namespace

Manager::Manager()
{
	const std::lock_guard<std::mutex> guard(lock);
	auto share = current.lock();

	if (share && share->outdated)
		throw Failure(-ENODEV, "it is about to begin anew");
	if (!share) {
		redirect_messages();
		share = std::make_shared<Library>();
		if (const int err = share->manager.start(); err)
			throw Failure(err, "it finds no devices at all", CAMERA_NO_DEVICE);
		current = share;
	}
	library = std::move(share);
}

Manager::~Manager()
{
	const std::lock_guard<std::mutex> guard(lock);

	library.reset(); /* the last share stops libcamera */
}

std::vector<std::shared_ptr<lc::Camera>> Manager::cameras() const
{
	return library->manager.cameras();
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
	const std::lock_guard<std::mutex> guard(lock);

	if (library->outdated || library.use_count() == 1 ||
	    library->kept == libcamera_hotplug_kept())
		return;
	library->outdated = true;
	log_info_paced("libcamera: it begins anew, as devices were plugged in");
}

bool Manager::is_outdated() const
{
	const std::lock_guard<std::mutex> guard(lock);

	return library->outdated;
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
		void run(lc::CameraManager *manager, std::shared_ptr<lc::Camera> what)
		{
			manager->removeCamera(what);
		}
	};
	Errand errand;

	errand.moveToThread(camera->thread());
	errand.invokeMethod(&Errand::run, lc::ConnectionTypeBlocking, &library->manager, camera);
#endif
}

bool Manager::made_of(const std::shared_ptr<lc::Camera> &camera, dev_t number) const
{
#if LIBCAMERA_AT_LEAST(0, 4)
	const auto numbers = camera->properties().get(lc::properties::SystemDevices);

	return numbers &&
	       std::find(numbers->begin(), numbers->end(), (int64_t)number) != numbers->end();
#else
	return library->manager.get(number) == camera;
#endif
}

std::string model_of(const lc::Camera &device)
{
	const auto model = device.properties().get(lc::properties::Model);

	return model ? std::string(*model) : std::string();
}

} // namespace libcamera_driver
