#include "drivers/v4l2/device.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

int device_ioctl(int fd, unsigned long request, void *argument)
{
	int got;

	do
		got = ioctl(fd, request, argument);
	while (got < 0 && errno == EINTR);
	return got < 0 ? -errno : 0;
}

enum camera_situation device_situation(int err)
{
	switch (-err) {
	case ENOENT:
	case ENODEV:
	case ENXIO:
		return CAMERA_NO_DEVICE;
	case EACCES:
	case EPERM:
		return CAMERA_NO_PERMISSION;
	case EBUSY:
		return CAMERA_BUSY;
	case ENOSPC: /* the USB host has no bandwidth left */
		return CAMERA_NO_BANDWIDTH;
	case ENOLINK: /* nothing is plugged into the input */
	case ENOLCK:  /* something is, but it is not stable */
		return CAMERA_NO_SIGNAL;
	default:
		return CAMERA_BROKEN;
	}
}

unsigned device_caps(const struct v4l2_capability *capability)
{
	return capability->capabilities & V4L2_CAP_DEVICE_CAPS ? capability->device_caps
							       : capability->capabilities;
}

bool device_captures(unsigned caps)
{
	return (caps & (V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_VIDEO_CAPTURE_MPLANE)) &&
	       (caps & V4L2_CAP_STREAMING);
}

int device_open(const char *path, struct v4l2_capability *capability, struct fault *fault)
{
	struct v4l2_capability own;
	int err, fd = open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC);

	if (fd < 0)
		return fault_say(fault, -errno, "%s: cannot open the camera: %s", path,
				 strerror(errno));
	if (!capability)
		capability = &own;
	memset(capability, 0, sizeof(*capability));
	err = device_ioctl(fd, VIDIOC_QUERYCAP, capability);
	if (err == -ENOTTY || err == -EINVAL)
		err = fault_say(fault, -ENOTTY, "%s: not a camera: expected a V4L2 device", path);
	else if (err)
		fault_say(fault, err, "%s: cannot ask the camera: %s", path, strerror(-err));
	else if (!device_captures(device_caps(capability)))
		err = fault_say(fault, -ENODEV,
				"%s: \"%s\" does not capture video: expected a camera", path,
				(const char *)capability->card);
	if (err) {
		close(fd);
		return err;
	}
	return fd;
}

static bool called(const struct v4l2_capability *capability, const char *name)
{
	return name[0] == '\0' || strcmp((const char *)capability->bus_info, name) == 0 ||
	       strcmp((const char *)capability->card, name) == 0;
}

static int not_found(const char *name, struct fault *fault)
{
	if (name[0])
		return fault_say(fault, -ENODEV,
				 "no camera \"%s\": expected /dev/videoN, or a name or bus that "
				 "`inlay devices` prints",
				 name);
	return fault_say(fault, -ENODEV, "no camera found: expected a capturing /dev/video*");
}

int device_find(const char *name, char path[INI_PATH_MAX], struct v4l2_capability *capability,
		struct fault *fault)
{
	struct fault last = {""};
	int reason = 0;

	if (name[0] == '/') {
		snprintf(path, INI_PATH_MAX, "%s", name);
		return device_open(path, capability, fault);
	}
	for (int i = 0; i < V4L2_DEVICES_MAX; i++) {
		int fd;

		snprintf(path, INI_PATH_MAX, "/dev/video%d", i);
		fd = device_open(path, capability, &last);
		if (fd >= 0 && called(capability, name))
			return fd;
		if (fd >= 0) {
			close(fd);
		} else if (device_situation(fd) == CAMERA_NO_PERMISSION) {
			/* It explains more than "not found" would. */
			reason = fd;
			fault_say(fault, fd, "%s", last.text);
		}
	}
	path[0] = '\0';
	return reason ? reason : not_found(name, fault);
}
