/* SPDX-License-Identifier: MIT */
#include "drivers/v4l2/v4l2.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "hal/base/utf8.h"

int device_ioctl(int fd, unsigned long request, void *argument)
{
	int got;

	do
		got = ioctl(fd, request, argument);
	while (got < 0 && errno == EINTR);
	return got < 0 ? -errno : 0;
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

bool device_is_part(const struct v4l2_capability *capability)
{
	/* Image processors whose drivers do not tell V4L2_CAP_IO_MC. */
	static const char *const processors[] = {"bcm2835-isp", "bcm2835-codec", "pispbe"};

	for (size_t i = 0; i < sizeof(processors) / sizeof(processors[0]); i++)
		if (strncmp((const char *)capability->card, processors[i], strlen(processors[i])) ==
			    0 ||
		    strncmp((const char *)capability->driver, processors[i],
			    strlen(processors[i])) == 0)
			return true;
	return device_caps(capability) & V4L2_CAP_IO_MC;
}

unsigned device_buffer_type(const struct v4l2_capability *capability)
{
	return device_caps(capability) & V4L2_CAP_VIDEO_CAPTURE
		       ? V4L2_BUF_TYPE_VIDEO_CAPTURE
		       : V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
}

void device_name(const uint8_t card[32], char *name, size_t room)
{
	char text[33] = "";
	size_t length;

	memcpy(text, card, 32);
	length = strlen(text);
	/* The kernel cuts at 31 bytes, which may be in the middle of a character. */
	for (size_t back = 1; length == 31 && back <= 3; back++) {
		const unsigned char first = (unsigned char)text[length - back];

		if ((first & 0xc0) == 0x80)
			continue;
		if (first >= 0xc0 && utf8_bytes(text + length - back) == 0)
			text[length - back] = '\0';
		break;
	}
	utf8_copy(name, room, text);
}

int device_open(const char *path, struct v4l2_capability *capability, struct fault *fault)
{
	struct v4l2_capability own;
	int err, fd = open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC);

	if (fd < 0)
		return fault_say(fault, -errno, "%s: cannot open the camera: %s%s", path,
				 strerror(errno),
				 errno == EACCES ? " (is this user in the group \"video\"?)" : "");
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
