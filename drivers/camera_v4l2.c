/*
 * Cameras behind Video4Linux: webcams, frame grabbers, sensors with a single video node. Memory
 * mapped streaming, single- and multi-planar.
 *
 * Pictures are read by the processor (to decode them, to measure their light), in the driver's own
 * memory. Passing them on as DMABUF would save no copy, for there is none, and mapping one costs
 * cache maintenance at each frame on machines whose devices do not see the cache.
 */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <unistd.h>

#include "drivers/drivers.h"
#include "drivers/v4l2/buffers.h"
#include "drivers/v4l2/controls.h"
#include "drivers/v4l2/device.h"
#include "drivers/v4l2/fallback.h"
#include "drivers/v4l2/find.h"
#include "drivers/v4l2/formats.h"
#include "drivers/v4l2/listing.h"
#include "drivers/v4l2/setup.h"
#include "hal/camera_situation.h"
#include "hal/clock.h"
#include "hal/log.h"

#define SIGNAL_CHECK_NS NS_PER_S
/* An older time is of another clock, or of one that wrapped around; so is one that is yet to come.
 */
#define TIME_PAST_NS (60 * NS_PER_S)

static const struct ini_key v4l2_keys[] = {
	{"input", INI_TEXT, offsetof(struct v4l2_options, input), .fallback = "",
	 .help = "Which input of the device, by number or name; empty: the one that is selected."},
	{"standard", INI_TEXT, offsetof(struct v4l2_options, standard), .fallback = "",
	 .help = "Television standard: PAL, NTSC, SECAM or as the device names it; empty: as "
		 "detected."},
	{"field", INI_CHOICE, offsetof(struct v4l2_options, field),
	 .choices = v4l2_field_wish_names, .fallback = "driver",
	 .help = "How the two fields of interlaced video are asked for; driver: as it likes."},
	INI_KEYS_END,
};

/* A picture that came: one buffer, or two that hold a field each. */
struct taken {
	struct frame frame; /* PIXEL_NONE: nothing fit to be handed out */
	int buffers[2];	    /* -1: none */
};

struct v4l2 {
	int fd, events; /* events: an epoll of fd; -1: fd is enough */
	char path[INI_PATH_MAX];
	struct v4l2_source source;
	struct v4l2_picture picture;
	struct v4l2_buffers buffers;
	struct v4l2_settings controls;
	struct v4l2_pairing pairing;
	struct taken waiting; /* the first field of a pair */
	struct taken out;     /* handed out */
	bool counted;	      /* last_sequence holds one */
	uint32_t last_sequence;
	int64_t signal_checked_ns;
};

static const struct taken nothing = {.frame.format = PIXEL_NONE, .buffers = {-1, -1}};

static void v4l2_close(struct camera *camera)
{
	struct v4l2 *v = camera->state;

	camera->state = NULL;
	if (!v)
		return;
	v4l2_buffers_stop(&v->buffers);
	if (v->events >= 0)
		close(v->events);
	if (v->fd >= 0)
		close(v->fd);
	free(v);
}

/* ---- opening ---- */

static int open_device(struct camera *camera, struct v4l2 *v, struct fault *fault)
{
	struct v4l2_capability capability;

	v->fd = v4l2_find(camera->settings.device, v->path, &capability, fault);
	if (v->fd < 0)
		return v->fd;
	snprintf(camera->name, sizeof(camera->name), "%.*s", (int)sizeof(capability.card),
		 (const char *)capability.card);
	v->buffers.fd = v->fd;
	v->buffers.type = device_caps(&capability) & V4L2_CAP_VIDEO_CAPTURE
				  ? V4L2_BUF_TYPE_VIDEO_CAPTURE
				  : V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
	return 0;
}

static int start_once(struct camera *camera, struct v4l2 *v, const struct camera_settings *settings,
		      struct fault *fault)
{
	const struct v4l2_options *options = camera->options;
	int err;

	err = v4l2_setup_picture(v->fd, v->buffers.type, settings,
				 (enum v4l2_field_wish)options->field, &v->source, &v->picture,
				 &camera->rate_hz, fault);
	if (err == -ENOTSUP)
		camera->situation = CAMERA_UNSUPPORTED_FORMAT;
	if (err)
		return err;
	v->buffers.memory_planes = v->picture.layout->memory_planes;
	/* A pair of fields takes two. */
	return v4l2_buffers_start(
		&v->buffers, settings->buffers * (v->picture.lines.fields == FIELDS_PAIR ? 2 : 1),
		fault);
}

/* In plain words, for whoever has two cameras on one bus. */
static int no_room(const struct camera *camera, const char *wanted, struct fault *fault)
{
	const char *give_up = camera->settings.give_up;

	return fault_say(fault, -ENOSPC,
			 "the USB bus has no room for %s: cameras on one bus share its bandwidth; "
			 "%s%s%s, or move a camera to another USB controller",
			 wanted,
			 give_up[0] ? "nothing smaller is offered that give_up = \""
				    : "give_up is empty and forbids anything smaller",
			 give_up, give_up[0] ? "\" allows: ask for less" : "");
}

static int start(struct camera *camera, struct v4l2 *v, struct v4l2_fallback *fallback,
		 struct fault *fault)
{
	struct camera_settings settings = camera->settings;
	char wanted[80] = "what is wanted", instead[80];
	bool lessened = false;
	int err;

	for (;;) {
		memset(&v->picture, 0, sizeof(v->picture));
		err = start_once(camera, v, &settings, fault);
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
	log_warning("%s: the USB bus has no room for %s: cameras on one bus share its bandwidth. "
		    "Taken instead: %s (give_up = \"%s\" allows it)",
		    v->path, wanted, instead, camera->settings.give_up);
	return 0;
}

static int set_up(struct camera *camera, struct v4l2 *v, struct fault *fault)
{
	struct v4l2_fallback fallback;
	int err;

	err = v4l2_controls_read(&v->controls, camera->settings.controls, fault);
	if (!err)
		err = v4l2_fallback_read(&fallback, camera->settings.give_up, fault);
	if (!err)
		err = v4l2_setup_input(v->fd, camera->options, &v->source, fault);
	if (err)
		return err;
	v4l2_controls_apply(v->fd, v->path, &v->controls);
	err = start(camera, v, &fallback, fault);
	if (err)
		return err;
	v4l2_controls_confirm(v->fd, v->path, &v->controls);
	camera->format = v->picture.layout->format;
	camera->width = v->picture.width;
	camera->height = v->picture.height;
	return 0;
}

/* Events make a device's file poll as exceptional, not readable: an epoll of both polls readable.
 */
static int watch_events(struct v4l2 *v, struct fault *fault)
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

static void say_what_came(const struct camera *camera, const struct v4l2 *v)
{
	char text[80];

	v4l2_describe(&v->picture, camera->rate_hz, text, sizeof(text));
	log_info("%s: \"%s\" sends %s, %s", v->path, camera->name, text,
		 v4l2_lines_text(&v->picture.lines));
}

static int v4l2_open(struct camera *camera, struct fault *fault)
{
	struct v4l2 *v = calloc(1, sizeof(*v));
	struct fault why = {""};
	int err;

	if (!v)
		return fault_say(fault, -ENOMEM, "v4l2: no memory");
	v->fd = v->events = -1;
	v->waiting = v->out = nothing;
	camera->state = v;
	err = open_device(camera, v, fault);
	if (err)
		goto fail;
	err = set_up(camera, v, &why);
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
	const struct v4l2 *v = camera->state;

	return v->events >= 0 ? v->events : v->fd;
}

/* ---- one buffer ---- */

static int64_t timestamp_ns(const struct v4l2_buffer *buffer)
{
	const int64_t now_ns = clock_now_ns(), s = buffer->timestamp.tv_sec;
	int64_t ns;

	if ((buffer->flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) != V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC)
		return now_ns;
	if (s < 0 || s > now_ns / NS_PER_S)
		return now_ns;
	ns = s * NS_PER_S + (int64_t)buffer->timestamp.tv_usec * 1000;
	return ns < now_ns - TIME_PAST_NS || ns > now_ns ? now_ns : ns;
}

/* Sequence numbers wrap; a step back means that the driver started to count anew. */
static uint32_t missed(struct v4l2 *v, uint32_t sequence)
{
	const uint32_t step = sequence - v->last_sequence;
	const bool gap = v->counted && step > 1 && step < UINT32_MAX / 2;

	v->counted = true;
	v->last_sequence = sequence;
	return gap ? step - 1 : 0;
}

static struct v4l2_span span(const struct v4l2_mapping *mapping, size_t offset, size_t used)
{
	const size_t end = used < mapping->length ? used : mapping->length;

	if (offset >= end)
		return (struct v4l2_span){mapping->memory, 0};
	return (struct v4l2_span){mapping->memory + offset, end - offset};
}

/* False: the driver marked it as damaged, or it does not hold what it should. */
static bool read_buffer(const struct v4l2 *v, const struct v4l2_buffer *buffer, struct frame *frame)
{
	const struct v4l2_mapping *mapping = v->buffers.mappings[buffer->index];
	const struct v4l2_lines lines = v4l2_lines_of_buffer(&v->picture.lines, buffer->field,
							     v->picture.standard);
	struct v4l2_span memory[V4L2_PLANES_MAX] = {{NULL, 0}, {NULL, 0}};

	if (buffer->flags & V4L2_BUF_FLAG_ERROR)
		return false;
	if (!v4l2_multiplanar(&v->buffers))
		memory[0] = span(&mapping[0], 0, buffer->bytesused);
	for (int p = 0; v4l2_multiplanar(&v->buffers) && p < v->buffers.memory_planes; p++)
		memory[p] = span(&mapping[p], buffer->m.planes[p].data_offset,
				 buffer->m.planes[p].bytesused);
	*frame = (struct frame){
		.format = v->picture.layout->format,
		.width = v->picture.width,
		.height = v->picture.height,
		.fields = lines.fields,
		.bottom_first = lines.bottom_first,
		.matrix = v->picture.matrix,
		.range = v->picture.range,
		.timestamp_ns = timestamp_ns(buffer),
		.sequence = buffer->sequence,
		.buffer = (int)buffer->index,
	};
	return v4l2_fill_planes(&v->picture, memory, frame->planes);
}

static int give_back(struct v4l2 *v, struct taken *t)
{
	int first = 0;

	for (int i = 0; i < 2; i++) {
		const int err = t->buffers[i] >= 0 ? v4l2_buffers_queue(&v->buffers, t->buffers[i])
						   : 0;

		first = first ? first : err;
	}
	*t = nothing;
	return first;
}

/* ---- fields in turn ---- */

static void join(struct taken *pair, const struct taken *second, bool second_is_bottom)
{
	struct frame *f = &pair->frame;
	const size_t bytes = sizeof(f->planes);

	if (second_is_bottom) {
		memcpy(f->bottom_planes, second->frame.planes, bytes);
	} else {
		memcpy(f->bottom_planes, f->planes, bytes);
		memcpy(f->planes, second->frame.planes, bytes);
	}
	f->bottom_first = !second_is_bottom;
	f->timestamp_ns = second->frame.timestamp_ns; /* whole only then */
	pair->buffers[1] = second->buffers[0];
}

/* A field came, fit or not; what makes a picture with it, if anything does, replaces it. A picture
 * of which either field is unfit or lost is counted broken once. */
static int pair_up(struct camera *camera, struct v4l2 *v, struct taken *t, uint32_t sequence,
		   bool bottom)
{
	struct taken first = v->waiting;
	int err = 0;

	switch (v4l2_pairing_take(&v->pairing, sequence, bottom, v->picture.lines.bottom_first)) {
	case V4L2_PAIR_ORPHAN:
		camera->broken++;
		err = give_back(v, &first);
		v->waiting = *t;
		*t = nothing;
		return err;
	case V4L2_PAIR_FIRST:
		v->waiting = *t;
		*t = nothing;
		return 0;
	default:
		v->waiting = nothing;
	}
	if (first.frame.format != PIXEL_NONE && t->frame.format != PIXEL_NONE) {
		join(&first, t, bottom);
		*t = first;
		return 0;
	}
	camera->broken++;
	err = give_back(v, &first);
	return err ? err : give_back(v, t);
}

/* A buffer that does not say which field it holds belongs to no pair. */
static bool is_field(uint32_t field)
{
	return field == V4L2_FIELD_TOP || field == V4L2_FIELD_BOTTOM;
}

/* One buffer from the driver; an unfit one, or a first field, leaves nothing. */
static int take(struct camera *camera, struct v4l2 *v, struct taken *t)
{
	struct v4l2_plane planes[VIDEO_MAX_PLANES];
	struct v4l2_buffer buffer;
	const bool pairs = v->picture.lines.fields == FIELDS_PAIR;
	bool fit;
	int err;

	*t = nothing;
	err = v4l2_buffers_take(&v->buffers, &buffer, planes);
	if (err)
		return err;
	camera->lost += missed(v, v->pairing.counts_fields ? buffer.sequence / 2 : buffer.sequence);
	fit = read_buffer(v, &buffer, &t->frame) && (!pairs || is_field(buffer.field));
	t->buffers[0] = (int)buffer.index;
	if (!fit)
		err = give_back(v, t);
	if (err)
		return err;
	if (pairs && is_field(buffer.field))
		return pair_up(camera, v, t, buffer.sequence, buffer.field == V4L2_FIELD_BOTTOM);
	camera->broken += !fit;
	return 0;
}

/* ---- grabbing ---- */

static int take_newest(struct camera *camera, struct v4l2 *v, struct taken *newest)
{
	/* Never more than there are buffers, however fast the camera is. */
	for (int i = 0; i < v->buffers.count; i++) {
		struct taken next;
		int err = take(camera, v, &next);

		if (err)
			return err;
		if (next.frame.format == PIXEL_NONE)
			continue;
		if (newest->frame.format != PIXEL_NONE) {
			camera->lost++;
			err = give_back(v, newest);
		}
		*newest = next;
		if (err)
			return err;
	}
	return 0;
}

/* A device that does not tell is asked, now and then: many digitizers without a signal go on
 * sending noise. */
static int signal_lost(struct v4l2 *v, struct fault *fault)
{
	const int64_t now_ns = clock_now_ns();

	if (v->source.tells || !v->source.standard ||
	    now_ns - v->signal_checked_ns < SIGNAL_CHECK_NS)
		return 0;
	v->signal_checked_ns = now_ns;
	return v4l2_check_signal(v->fd, &v->source, fault);
}

static int check_source(struct camera *camera, struct v4l2 *v, struct fault *fault)
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
	struct v4l2 *v = camera->state;
	int err = check_source(camera, v, fault);

	if (err)
		return err;
	err = take_newest(camera, v, &v->out);
	if (v->out.frame.format != PIXEL_NONE) {
		*frame = v->out.frame; /* trouble that came after it shows at the next call */
		return 0;
	}
	if (err == 0 || err == -EAGAIN)
		return -EAGAIN;
	camera->situation = camera_situation_of(err);
	return fault_say(fault, err == -ENXIO ? -ENODEV : err, "%s: %s", v->path,
			 err == -ENODEV || err == -ENXIO ? "the camera has gone" : strerror(-err));
}

/* A device that is gone takes no buffer back; grab() will say so. */
static void v4l2_release(struct camera *camera, struct frame *frame)
{
	struct v4l2 *v = camera->state;

	(void)frame;
	(void)give_back(v, &v->out);
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
};
