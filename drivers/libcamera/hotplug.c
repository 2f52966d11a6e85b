/* SPDX-License-Identifier: MIT */
#include "drivers/libcamera/parts.h"

#include <dlfcn.h>
#include <stdatomic.h>
#include <string.h>
#include <unistd.h>

struct udev_device;

/* These replace libudev's functions of the same names: libcamera has no other way to filter
 * news. */
const char *udev_device_get_action(struct udev_device *device);
const char *udev_device_get_devnode(struct udev_device *device);

static atomic_uint kept; /* once per process, as the functions of libudev are */

/* Calls libudev's own function. Returns "" in place of NULL, because libcamera makes a std::string
 * of the answer. */
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
 * Answers "change", which libcamera ignores, for every new device. A NULL device means that udev's
 * messages overflowed the socket; new devices may be among the lost ones.
 *
 * A "remove" may come late, when a new device has the same node already. libcamera compares only
 * the path: it would disconnect the new camera and abort the program at that camera's next frame.
 * So a removal is passed on only if the node does not exist.
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
