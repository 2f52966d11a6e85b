/* SPDX-License-Identifier: MIT */
#include "hal/device/camera.h"

#include <ctype.h>
#include <errno.h>
#include <stdbool.h>
#include <string.h>

const char *const camera_situation_names[] = {
	"fine",
	"no device",
	"no signal",
	"stalled",
	"damaged pictures",
	"unsupported format",
	"busy",
	"no bandwidth",
	"no permission",
	"broken",
	NULL,
};

_Static_assert(sizeof(camera_situation_names) / sizeof(camera_situation_names[0]) ==
		       CAMERA_SITUATION_COUNT + 1,
	       "a name for each situation");

int camera_open(struct camera *camera, const struct camera_ops *ops,
		const struct camera_settings *settings, void *options, struct fault *fault)
{
	int err;

	memset(camera, 0, sizeof(*camera));
	camera->ops = ops;
	camera->settings = *settings;
	camera->options = options;
	err = ops->open(camera, fault);
	if (err && camera->situation == CAMERA_FINE)
		camera->situation = CAMERA_BROKEN;
	if (err)
		ops->close(camera);
	return err;
}

int camera_descriptor(struct camera *camera)
{
	return camera->state ? camera->ops->descriptor(camera) : -EBADF;
}

int camera_grab(struct camera *camera, struct frame *frame, struct fault *fault)
{
	int err;

	memset(frame, 0, sizeof(*frame));
	if (!camera->state)
		return fault_say(fault, -EBADF, "a camera that is not open");
	err = camera->ops->grab(camera, frame, fault);
	if (err == 0) {
		camera->frames++;
		camera->situation = CAMERA_FINE;
	} else if (err == -ENODEV && camera->situation == CAMERA_FINE) {
		camera->situation = CAMERA_NO_DEVICE;
	} else if (err != -EAGAIN && err != -ESTALE && camera->situation == CAMERA_FINE) {
		camera->situation = CAMERA_BROKEN;
	}
	return err;
}

void camera_release(struct camera *camera, struct frame *frame)
{
	if (camera->state && frame->format != PIXEL_NONE)
		camera->ops->release(camera, frame);
	memset(frame, 0, sizeof(*frame));
}

int camera_set_control(struct camera *camera, const char *name, const char *value, double *taken,
		       struct fault *fault)
{
	double unwanted;

	if (!camera->state)
		return fault_say(fault, -EBADF, "a camera that is not open");
	if (!camera->ops->control)
		return fault_say(
			fault, -ENOTSUP,
			"%s: cameras of this driver have no control that could be changed while they stream",
			camera->ops->name);
	return camera->ops->control(camera, name, value, taken ? taken : &unwanted, fault);
}

void camera_close(struct camera *camera)
{
	if (camera->ops)
		camera->ops->close(camera);
	camera->state = NULL;
}

enum camera_situation camera_situation_of(int err)
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
	case ENOSPC: /* the bus has no bandwidth left */
		return CAMERA_NO_BANDWIDTH;
	case ENOLINK: /* no source is plugged into the input */
	case ENOLCK:  /* the source's signal is not stable */
	case ERANGE:  /* the input cannot receive the signal, for example while its source starts */
		return CAMERA_NO_SIGNAL;
	default:
		return CAMERA_BROKEN;
	}
}

bool camera_is_hopeless(enum camera_situation situation, int err)
{
	/* A camera of another kind may be plugged in; but a simulated one is what the configuration
	 * makes it. */
	if (situation == CAMERA_UNSUPPORTED_FORMAT)
		return err == -EINVAL;
	if (situation != CAMERA_BROKEN)
		return false;
	switch (-err) {
	case ENOTTY: /* not a camera */
	case EINVAL: /* no such input, standard or size */
	case ENOTSUP:
	case EISDIR: /* from here on: files that a simulated camera plays */
	case EBADMSG:
	case EFBIG:
	case EDOM:
		return true;
	default:
		return false;
	}
}

static const enum pixel_format cheapest_first[] = {
	PIXEL_BGRX,  PIXEL_BGR24, PIXEL_RGB24, PIXEL_YUYV, PIXEL_UYVY, PIXEL_YVYU,
	PIXEL_NV16,  PIXEL_NV12,  PIXEL_NV21,  PIXEL_YU12, PIXEL_YV12, PIXEL_P010,
	PIXEL_MJPEG, PIXEL_GREY,  PIXEL_Y16,   PIXEL_Y14,  PIXEL_Y12,  PIXEL_Y10,
};

enum { FORMATS = sizeof(cheapest_first) / sizeof(cheapest_first[0]) };

int camera_format_merit(enum pixel_format format, bool size, bool rate)
{
	if (format == PIXEL_Z16)
		return 1; /* no picture, but what a depth camera is opened for */
	if (format == PIXEL_H264)
		return 2; /* even where nothing else has the size: damage stays for seconds */
	for (int i = 0; i < FORMATS; i++)
		if (cheapest_first[i] == format)
			return FORMATS - i + 2 + (size ? FORMATS : 0) +
			       (size && rate ? FORMATS : 0);
	return 0;
}

/* Copies the text between from and end without blanks around it. False: empty, or too long. */
static bool copy_trimmed(const char *from, const char *end, char *to, size_t size)
{
	size_t length;

	while (from < end && isspace((unsigned char)*from))
		from++;
	while (from < end && isspace((unsigned char)end[-1]))
		end--;
	length = (size_t)(end - from);
	if (length == 0 || length >= size)
		return false;
	memcpy(to, from, length);
	to[length] = '\0';
	return true;
}

int camera_controls_next(const char **text, struct camera_control *control, struct fault *fault)
{
	const char *const start = *text + strspn(*text, " \t,"), *const end = strchrnul(start, ',');
	const char *const equals = memchr(start, '=', (size_t)(end - start));

	*text = end;
	if (start == end)
		return 0;
	if (!equals || !copy_trimmed(start, equals, control->name, sizeof(control->name)) ||
	    !copy_trimmed(equals + 1, end, control->value, sizeof(control->value)))
		return fault_say(fault, -EINVAL,
				 "controls: \"%.*s\", expected name=value, name=value",
				 (int)(end - start), start);
	return 1;
}
