/* SPDX-License-Identifier: MIT */
/*
 * Cameras behind Video4Linux: webcams, frame grabbers, sensors with a single video node. Memory
 * mapped streaming, single- and multi-planar.
 *
 * The processor reads pictures in the driver's own memory, to decode them and to measure their
 * light. DMABUF would save no copy, for there is none, and would cost cache maintenance at each
 * frame on machines whose devices are not cache-coherent.
 */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <unistd.h>

#include "drivers/drivers.h"
#include "drivers/v4l2/v4l2.h"
#include "hal/base/clock.h"
#include "hal/base/log.h"
#include "hal/device/camera.h"

#define SIGNAL_CHECK_NS NS_PER_S

static const struct ini_key v4l2_keys[] = {
	{"input", INI_TEXT, offsetof(struct v4l2_options, input), .fallback = "",
	 .help = "Which input of the device, by number or name; empty: the one that is selected."},
	{"standard", INI_TEXT, offsetof(struct v4l2_options, standard), .fallback = "",
	 .help = "Television standard: PAL, NTSC, SECAM or as the device names it; empty: as detected."},
	{"field", INI_CHOICE, offsetof(struct v4l2_options, field),
	 .choices = v4l2_field_wish_names, .fallback = "driver",
	 .help = "How the two fields of interlaced video are asked for; driver: as it likes."},
	INI_KEYS_END,
};

static void v4l2_close(struct camera *camera)
{
	struct v4l2_capture *v = camera->state;

	camera->state = NULL;
	if (!v)
		return;
	v4l2_buffers_stop(&v->buffers);
	h264_destroy(v->h264);
	if (v->events >= 0)
		close(v->events);
	if (v->fd >= 0)
		close(v->fd);
	free(v);
}

/* ---- opening ---- */

static int open_device(struct camera *camera, struct v4l2_capture *v, struct fault *fault)
{
	struct v4l2_capability capability;

	v->fd = v4l2_find(camera->settings.device, camera->settings.format == PIXEL_Z16, v->path,
			  &capability, fault);
	if (v->fd < 0)
		return v->fd;
	device_name(capability.card, camera->name, sizeof(camera->name));
	v->buffers.fd = v->fd;
	v->buffers.type = device_buffer_type(&capability);
	return 0;
}

static int v4l2_start_once(struct camera *camera, struct v4l2_capture *v,
			   const struct camera_settings *settings, struct fault *fault)
{
	const struct v4l2_options *options = camera->options;
	int buffers = settings->buffers, err;

	err = v4l2_setup_picture(v->fd, v->buffers.type, settings,
				 (enum v4l2_field_wish)options->field, &v->source, &v->picture,
				 &camera->rate_hz, fault);
	if (err == -ENOTSUP)
		camera->situation = CAMERA_UNSUPPORTED_FORMAT;
	if (err)
		return err;
	v->buffers.memory_planes = v->picture.layout->memory_planes;
	/* A pair of fields takes two buffers. Of H.264 a lost frame costs all that follow. */
	if (v->picture.layout->format == PIXEL_H264)
		buffers = V4L2_BUFFERS_MAX;
	else if (v->picture.lines.fields == FIELDS_PAIR)
		buffers *= 2;
	return v4l2_buffers_start(&v->buffers, buffers, fault);
}

/* The message says in plain words that two cameras on one bus share its bandwidth. */
static int no_room(const struct camera *camera, const char *wanted, struct fault *fault)
{
	const char *give_up = camera->settings.give_up;

	return fault_say(
		fault, -ENOSPC,
		"the USB bus has no room for %s: cameras on one bus share its bandwidth; %s%s%s, or move a camera to another USB controller",
		wanted,
		give_up[0] ? "nothing smaller is offered that give_up = \""
			   : "give_up is empty and forbids anything smaller",
		give_up, give_up[0] ? "\" allows: ask for less" : "");
}

static int v4l2_start(struct camera *camera, struct v4l2_capture *v, struct v4l2_fallback *fallback,
		      struct fault *fault)
{
	struct camera_settings settings = camera->settings;
	char wanted[80] = "what is wanted", instead[80];
	bool lessened = false;
	int err;

	for (;;) {
		memset(&v->picture, 0, sizeof(v->picture));
		err = v4l2_start_once(camera, v, &settings, fault);
		if (err != -ENOSPC)
			break;
		if (!lessened && v->picture.layout)
			v4l2_describe(&v->picture, camera->rate_hz, wanted, sizeof(wanted));
		if (!v->picture.layout ||
		    !v4l2_fallback_step(fallback, v->fd, v->buffers.type, &v->picture,
					camera->rate_hz, &settings))
			return no_room(camera, wanted, fault);
		lessened = true;
	}
	if (err || !lessened)
		return err;
	v4l2_describe(&v->picture, camera->rate_hz, instead, sizeof(instead));
	log_warning_paced(
		"%s: the USB bus has no room for %s: cameras on one bus share its bandwidth. Taken instead: %s (give_up = \"%s\" allows it)",
		v->path, wanted, instead, camera->settings.give_up);
	return 0;
}

/* Asks first whether another program streams: inputs and controls could be changed under it, and a
 * kiosk that waits for the camera would do so every second. Controls go before the format, because
 * some change the format and are locked once there are buffers. */
static int v4l2_set_up(struct camera *camera, struct v4l2_capture *v, struct fault *fault)
{
	struct v4l2_fallback fallback;
	int err;

	err = v4l2_controls_read(&v->controls, camera->settings.controls, fault);
	if (!err)
		err = v4l2_fallback_read(&fallback, camera->settings.give_up, fault);
	if (!err)
		err = v4l2_buffers_try(&v->buffers, fault);
	if (!err)
		err = v4l2_setup_input(v->fd, camera->options, &v->source, fault);
	if (err)
		return err;
	v4l2_controls_apply(v->fd, v->path, &v->controls);
	err = v4l2_start(camera, v, &fallback, fault);
	if (err)
		return err;
	v4l2_controls_confirm(v->fd, v->path, &v->controls);
	if (v->picture.layout->format == PIXEL_H264)
		err = h264_create(&v->h264, fault);
	if (err)
		return err;
	camera->format = v->picture.layout->format;
	camera->width = v->picture.width;
	camera->height = v->picture.height;
	return 0;
}

/* A device with a pending event polls as exceptional (POLLPRI), not as readable. An epoll that
 * waits for both polls readable. */
static int watch_events(struct v4l2_capture *v, struct fault *fault)
{
	struct epoll_event both = {.events = EPOLLIN | EPOLLPRI};

	if (!v->source.tells)
		return 0;
	v->events = epoll_create1(EPOLL_CLOEXEC);
	if (v->events < 0)
		return fault_say(fault, -errno, "cannot wait for events: %s", strerror(errno));
	if (epoll_ctl(v->events, EPOLL_CTL_ADD, v->fd, &both))
		return fault_say(fault, -errno, "cannot wait for events: %s", strerror(errno));
	return 0;
}

static void say_what_came(const struct camera *camera, const struct v4l2_capture *v)
{
	char text[80];

	v4l2_describe(&v->picture, camera->rate_hz, text, sizeof(text));
	log_info_paced("%s: \"%s\" sends %s, %s", v->path, camera->name, text,
		       v4l2_lines_text(&v->picture.lines));
}

static int v4l2_open(struct camera *camera, struct fault *fault)
{
	struct v4l2_capture *v = calloc(1, sizeof(*v));
	struct fault why = {""};
	int err;

	if (!v)
		return fault_say(fault, -ENOMEM, "v4l2: no memory");
	v->fd = v->events = -1;
	v->waiting = v->out = v4l2_nothing;
	camera->state = v;
	err = open_device(camera, v, fault);
	if (err)
		goto fail;
	err = v4l2_set_up(camera, v, &why);
	if (!err)
		err = watch_events(v, &why);
	if (err) {
		fault_say(fault, err, "%s: %s", v->path, why.text);
		goto fail;
	}
	v->signal_checked_ns = clock_now_ns();
	say_what_came(camera, v);
	return 0;
fail:
	if (camera->situation == CAMERA_FINE)
		camera->situation = camera_situation_of(err);
	v4l2_close(camera);
	return err;
}

static int v4l2_descriptor(struct camera *camera)
{
	const struct v4l2_capture *v = camera->state;

	return v->events >= 0 ? v->events : v->fd;
}

/* ---- grabbing ---- */

static int take_newest(struct camera *camera, struct v4l2_capture *v, struct v4l2_taken *newest)
{
	/* At most as often as there are buffers, however fast the camera is. */
	for (int i = 0; i < v->buffers.count; i++) {
		struct v4l2_taken next;
		int err = v4l2_take(camera, v, &next);

		if (err)
			return err;
		if (next.frame.format == PIXEL_NONE)
			continue;
		if (newest->frame.format != PIXEL_NONE) {
			camera->lost++;
			err = v4l2_give_back(v, newest);
		}
		*newest = next;
		if (err)
			return err;
	}
	return 0;
}

/* Asks a device that sends no events once a second: many digitizers without a signal go on sending
 * noise. */
static int signal_lost(struct v4l2_capture *v, struct fault *fault)
{
	const int64_t now_ns = clock_now_ns();

	if (v->source.tells || !v->source.standard ||
	    now_ns - v->signal_checked_ns < SIGNAL_CHECK_NS)
		return 0;
	v->signal_checked_ns = now_ns;
	return v4l2_check_signal(v->fd, &v->source, fault);
}

static int check_source(struct camera *camera, struct v4l2_capture *v, struct fault *fault)
{
	struct fault why = {""};
	int err;

	if (v->source.tells && v4l2_source_changed(v->fd))
		return fault_say(fault, -ESTALE, "%s: the source sends another picture now",
				 v->path);
	err = signal_lost(v, &why);
	if (!err)
		return 0;
	camera->situation = CAMERA_NO_SIGNAL;
	return fault_say(fault, err, "%s: %s", v->path, why.text);
}

static int v4l2_grab(struct camera *camera, struct frame *frame, struct fault *fault)
{
	struct v4l2_capture *v = camera->state;
	int err = check_source(camera, v, fault);

	if (err)
		return err;
	err = take_newest(camera, v, &v->out);
	if (v->out.frame.format != PIXEL_NONE) {
		*frame = v->out.frame; /* the next call reports an error that came after it */
		return 0;
	}
	if (err == 0 || err == -EAGAIN)
		return -EAGAIN;
	camera->situation = camera_situation_of(err);
	return fault_say(fault, err == -ENXIO ? -ENODEV : err, "%s: %s", v->path,
			 err == -ENODEV || err == -ENXIO ? "the camera has gone" : strerror(-err));
}

/* A lost device takes no buffer back; the next grab() reports it. */
static void v4l2_release(struct camera *camera, struct frame *frame)
{
	struct v4l2_capture *v = camera->state;

	(void)frame;
	(void)v4l2_give_back(v, &v->out);
}

static int v4l2_control(struct camera *camera, const char *name, const char *value, double *taken,
			struct fault *fault)
{
	const struct v4l2_capture *v = camera->state;

	return v4l2_control_change(v->fd, v->path, name, value, taken, fault);
}

const struct camera_ops camera_v4l2 = {
	.name = "v4l2",
	.description = "Video4Linux: webcams, frame grabbers, sensors",
	.keys = v4l2_keys,
	.options_size = sizeof(struct v4l2_options),
	.list = v4l2_list,
	.open = v4l2_open,
	.descriptor = v4l2_descriptor,
	.grab = v4l2_grab,
	.release = v4l2_release,
	.close = v4l2_close,
	.control = v4l2_control,
};
