#include "drivers/libcamera/hotplug.h"

#include <dlfcn.h>
#include <stdatomic.h>
#include <string.h>

struct udev_device;

/* libudev's own name: libcamera, which knows no other way to be told, calls this one instead. */
const char *udev_device_get_action(struct udev_device *device);

static atomic_uint kept;

const char *udev_device_get_action(struct udev_device *device)
{
	const char *(*real)(struct udev_device *);
	const char *action;

	*(void **)&real = dlsym(RTLD_NEXT, "udev_device_get_action");
	action = real ? real(device) : NULL;
	if (!action)
		return "";
	if (strcmp(action, "add"))
		return action;
	atomic_fetch_add(&kept, 1);
	return "change"; /* which libcamera takes no notice of */
}

unsigned libcamera_hotplug_kept(void)
{
	return atomic_load(&kept);
}
