/* SPDX-License-Identifier: MIT */
#include "drivers/libcamera/hotplug.h"

#include <dlfcn.h>
#include <stdatomic.h>
#include <string.h>
#include <unistd.h>

struct udev_device;

/* libudev's own names: libcamera, which knows no other way to be told, calls these instead. */
const char *udev_device_get_action(struct udev_device *device);
const char *udev_device_get_devnode(struct udev_device *device);

static atomic_uint kept;

/* What libudev's own function of that name says of the device; "" in place of NULL, of which
 * libcamera would make a std::string. */
static const char *udev_answer(const char *function, struct udev_device *device)
{
	const char *(*real)(struct udev_device *);
	const char *answer;

	*(void **)&real = dlsym(RTLD_NEXT, function);
	answer = device && real ? real(device) : NULL;
	return answer ? answer : "";
}

const char *udev_device_get_devnode(struct udev_device *device)
{
	return udev_answer("udev_device_get_devnode", device);
}

/*
 * libcamera takes no notice of "change". It gets NULL for a device when udev's messages were more
 * than the socket holds: new devices may be among those that were lost. And udev may be behind: a
 * removed device's node may exist again. libcamera compares nothing but its path. It would
 * disconnect the camera that is there now, and abort the program at that camera's next frame. Where
 * the node does not exist, whatever libcamera has found under its path is gone as well.
 */
const char *udev_device_get_action(struct udev_device *device)
{
	const char *const action = udev_answer("udev_device_get_action", device);

	if (!device || !strcmp(action, "add")) {
		atomic_fetch_add(&kept, 1);
		return "change";
	}
	if (!strcmp(action, "remove") && access(udev_device_get_devnode(device), F_OK) == 0)
		return "change";
	return action;
}

unsigned libcamera_hotplug_kept(void)
{
	return atomic_load(&kept);
}
