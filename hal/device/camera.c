/* SPDX-License-Identifier: MIT */
#include "hal/device/camera.h"

#include <errno.h>
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
