/* SPDX-License-Identifier: MIT */
/*
 * A V4L2 device that the test itself plays: an ordinary file is opened and mapped, and ioctl() is
 * answered here instead of by a kernel. What a real kernel answers is tests/vm's business; this is
 * about answers that no healthy driver gives on demand.
 *
 * Included by one file of a test program: it takes the place of the C library's ioctl() and
 * epoll_ctl(). Each plane's memory begins with a number of its own, buffer * 2 + plane + 1.
 */
#ifndef INLAY_TESTS_SUPPORT_PLAYED_V4L2_H
#define INLAY_TESTS_SUPPORT_PLAYED_V4L2_H

#include <errno.h>
#include <linux/videodev2.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "drivers/drivers.h"
#include "drivers/v4l2/device.h"
#include "drivers/v4l2/formats.h"
#include "drivers/v4l2/input.h"
#include "hal/base/clock.h"

enum { BUFFERS_MAX = 16, BUFFER_BYTES = 65536, QUEUE = 16, CONTROLS_MAX = 8 };
enum { YUYV_BYTES = 64 * 48 * 2 };

/* A picture that the played device has ready. */
struct ready {
	int buffer;
	uint32_t sequence, flags, field, bytes[2], data_offset;
	int64_t time_ns; /* 0: now */
};

struct played_control {
	const char *name;
	uint32_t type, flags;
	int minimum, maximum, value;
	int most;   /* what it makes of more; 0: it takes all */
	int step;   /* it rounds to multiples of it; 0: it takes all */
	int refuse; /* errno */
	int sets;   /* how often it was set */
};

static struct {
	const uint32_t *formats; /* 0 at the end */
	bool multiplanar, no_capture;
	unsigned width, height, stride_extra, colorspace, encoding, quantization, rate;
	uint32_t fourcc, field;
	bool sizes_known;    /* 64x48 and 32x24; fast only in MJPEG */
	double room;	     /* bits a second that the bus has left; 0: enough */
	bool room_at_format; /* S_FMT already minds, not STREAMON */
	int streamon_error, dequeue_error, signal_error, timings_error, interrupts;
	bool dv_timings, television, tells;
	uint32_t status; /* of the input */
	v4l2_std_id detected, standard;
	int input, events;
	struct played_control controls[CONTROLS_MAX];
	bool resets; /* the first control goes back to its minimum when the device starts */
	bool held;   /* by another program, which streams */
	bool streaming;
	int buffers, changes; /* changes: of input and standard */
	bool queued[BUFFERS_MAX];
	struct ready ready[QUEUE];
	int ready_count;
	uint32_t timestamp_flags;
} device;

static char path[] = "/tmp/inlay-v4l2.XXXXXX";
static int file = -1;

static int refuse(int err)
{
	errno = err;
	return -1;
}

static int fill_format(struct v4l2_format *f)
{
	const struct v4l2_layout *layout = v4l2_layout_of(device.fourcc);
	const unsigned stride =
		layout ? (unsigned)frame_plane_stride(layout->format, 0, (int)device.width) : 0;

	if (device.multiplanar) {
		struct v4l2_pix_format_mplane *m = &f->fmt.pix_mp;

		m->width = device.width;
		m->height = device.height;
		m->pixelformat = device.fourcc;
		m->field = device.field;
		m->num_planes = (uint8_t)(layout ? layout->memory_planes : 1);
		m->colorspace = device.colorspace;
		m->plane_fmt[0].bytesperline = stride + device.stride_extra;
		m->plane_fmt[1].bytesperline = stride + device.stride_extra + 2;
		return 0;
	}
	f->fmt.pix = (struct v4l2_pix_format){
		.width = device.width,
		.height = device.height,
		.pixelformat = device.fourcc,
		.field = device.field,
		.bytesperline = stride ? stride + device.stride_extra : 0,
		.colorspace = device.colorspace,
		.ycbcr_enc = device.encoding,
		.quantization = device.quantization,
	};
	return 0;
}

static bool room_is_short(void)
{
	return device.room > 0 &&
	       (double)v4l2_bits(device.fourcc) * device.width * device.height * device.rate >
		       device.room;
}

/* Television is sent as it is asked for, anything else progressive. */
static int take_format(struct v4l2_format *f)
{
	const uint32_t asked = device.multiplanar ? f->fmt.pix_mp.field : f->fmt.pix.field;

	device.fourcc = device.multiplanar ? f->fmt.pix_mp.pixelformat : f->fmt.pix.pixelformat;
	device.width = device.multiplanar ? f->fmt.pix_mp.width : f->fmt.pix.width;
	device.height = device.multiplanar ? f->fmt.pix_mp.height : f->fmt.pix.height;
	if (device.television)
		device.field = asked == V4L2_FIELD_ANY ? V4L2_FIELD_INTERLACED : asked;
	if (device.room_at_format && room_is_short())
		return refuse(ENOSPC);
	return fill_format(f);
}

static int enumerate_format(struct v4l2_fmtdesc *f)
{
	for (unsigned i = 0; device.formats[i]; i++)
		if (i == f->index) {
			f->pixelformat = device.formats[i];
			return 0;
		}
	return refuse(EINVAL);
}

static int enumerate_size(struct v4l2_frmsizeenum *f)
{
	if (!device.sizes_known || f->index > 1)
		return refuse(EINVAL);
	f->type = V4L2_FRMSIZE_TYPE_DISCRETE;
	f->discrete.width = f->index ? 32 : 64;
	f->discrete.height = f->index ? 24 : 48;
	return 0;
}

/* MJPEG at 30, 15 and 5 a second, others at 5. */
static int enumerate_rate(struct v4l2_frmivalenum *f)
{
	static const unsigned rates[] = {30, 15, 5};
	const unsigned first = f->pixel_format == V4L2_PIX_FMT_MJPEG ? 0 : 2;

	if (!device.sizes_known || f->index + first > 2)
		return refuse(EINVAL);
	f->type = V4L2_FRMIVAL_TYPE_DISCRETE;
	f->discrete.numerator = 1;
	f->discrete.denominator = rates[first + f->index];
	return 0;
}

static int query_buffer(struct v4l2_buffer *b)
{
	const unsigned planes = device.multiplanar ? b->length : 1;

	if (!device.multiplanar) {
		b->length = BUFFER_BYTES;
		b->m.offset = b->index * 2 * BUFFER_BYTES;
		return 0;
	}
	for (unsigned p = 0; p < planes; p++) {
		b->m.planes[p].length = BUFFER_BYTES;
		b->m.planes[p].m.mem_offset = (b->index * 2 + p) * BUFFER_BYTES;
	}
	return 0;
}

static int request_buffers(struct v4l2_requestbuffers *r)
{
	assert_false(device.streaming);
	if (device.held)
		return refuse(EBUSY);
	if (r->count > BUFFERS_MAX)
		r->count = BUFFERS_MAX;
	device.buffers = (int)r->count;
	memset(device.queued, 0, sizeof(device.queued));
	return 0;
}

static int dequeue(struct v4l2_buffer *b)
{
	const struct ready r = device.ready[0];
	const int64_t time_ns = r.time_ns ? r.time_ns : clock_now_ns();

	if (device.dequeue_error)
		return refuse(device.dequeue_error);
	if (device.ready_count == 0)
		return refuse(EAGAIN);
	memmove(device.ready, device.ready + 1, sizeof(device.ready) - sizeof(device.ready[0]));
	device.ready_count--;
	assert_true(device.queued[r.buffer]);
	device.queued[r.buffer] = false;
	b->index = (unsigned)r.buffer;
	b->sequence = r.sequence;
	b->field = r.field;
	b->flags = r.flags | device.timestamp_flags;
	b->timestamp = (struct timeval){.tv_sec = time_ns / NS_PER_S,
					.tv_usec = time_ns % NS_PER_S / 1000};
	b->bytesused = r.bytes[0];
	for (unsigned p = 0; device.multiplanar && p < b->length; p++) {
		b->m.planes[p].bytesused = r.bytes[p];
		b->m.planes[p].data_offset = r.data_offset;
	}
	return 0;
}

static int start_streaming(void)
{
	if (device.streamon_error)
		return refuse(device.streamon_error);
	if (room_is_short())
		return refuse(ENOSPC);
	if (device.resets)
		device.controls[0].value = device.controls[0].minimum;
	device.streaming = true;
	return 0;
}

/* ---- inputs ---- */

static int enumerate_input(struct v4l2_input *input)
{
	static const char *const names[] = {"Composite 0", "S-Video"};

	if (input->index > 1)
		return refuse(EINVAL);
	snprintf((char *)input->name, sizeof(input->name), "%s", names[input->index]);
	input->capabilities = (device.dv_timings ? V4L2_IN_CAP_DV_TIMINGS : 0) |
			      (device.television ? V4L2_IN_CAP_STD : 0);
	input->std = device.television ? V4L2_STD_PAL_BG | V4L2_STD_NTSC_M : 0;
	input->status = device.status;
	return 0;
}

static int enumerate_standard(struct v4l2_standard *s)
{
	static const struct {
		const char *name;
		v4l2_std_id id;
	} listed[] = {{"NTSC-M", V4L2_STD_NTSC_M}, {"PAL-BG", V4L2_STD_PAL_BG}};

	if (!device.television || s->index > 1)
		return refuse(EINVAL);
	snprintf((char *)s->name, sizeof(s->name), "%s", listed[s->index].name);
	s->id = listed[s->index].id;
	return 0;
}

static int next_event(struct v4l2_event *event)
{
	if (device.events == 0)
		return refuse(ENOENT);
	event->type = V4L2_EVENT_SOURCE_CHANGE;
	event->pending = (unsigned)--device.events;
	return 0;
}

/* ---- controls: the n-th has the number CID + n ---- */

enum { CID = 0x980900 };

static struct played_control *control_of(uint32_t id)
{
	struct played_control *c = &device.controls[(id - CID) % CONTROLS_MAX];

	return id >= CID && id < CID + CONTROLS_MAX && c->name ? c : NULL;
}

static int query_control(struct v4l2_query_ext_ctrl *query)
{
	const bool next = query->id & V4L2_CTRL_FLAG_NEXT_CTRL;
	const uint32_t asked = query->id & ~(uint32_t)V4L2_CTRL_FLAG_NEXT_CTRL;
	const uint32_t id = !next ? asked : asked < CID ? CID : asked + 1;
	const struct played_control *c = control_of(id);

	if (!c)
		return refuse(EINVAL);
	*query = (struct v4l2_query_ext_ctrl){.id = id,
					      .type = c->type,
					      .minimum = c->minimum,
					      .maximum = c->maximum,
					      .flags = c->flags,
					      .elems = 1};
	snprintf(query->name, sizeof(query->name), "%s", c->name);
	return 0;
}

static int query_menu(struct v4l2_querymenu *menu)
{
	static const char *const entries[] = {"Disabled", "50 Hz", "60 Hz"};

	if (menu->index > 2)
		return refuse(EINVAL);
	snprintf((char *)menu->name, sizeof(menu->name), "%s", entries[menu->index]);
	return 0;
}

static int get_control(struct v4l2_ext_control *one)
{
	const struct played_control *c = control_of(one->id);

	if (!c)
		return refuse(EINVAL);
	one->value = c->value;
	return 0;
}

static int set_control(const struct v4l2_ext_control *one)
{
	struct played_control *c = control_of(one->id);

	if (!c || c->refuse)
		return refuse(c ? c->refuse : EINVAL);
	if (one->value < c->minimum || one->value > c->maximum)
		return refuse(ERANGE);
	c->value = c->most && one->value > c->most ? c->most : one->value;
	if (c->step)
		c->value = (c->value + c->step / 2) / c->step * c->step;
	c->sets++;
	return 0;
}

/* ---- all of it ---- */

static int answer_source(unsigned long request, void *argument)
{
	switch (request) {
	case VIDIOC_G_INPUT:
		*(int *)argument = device.input;
		return 0;
	case VIDIOC_S_INPUT:
		device.changes++;
		device.input = *(int *)argument;
		return device.input < 2 ? 0 : refuse(EINVAL);
	case VIDIOC_ENUMINPUT:
		return enumerate_input(argument);
	case VIDIOC_QUERY_DV_TIMINGS:
		return device.signal_error ? refuse(device.signal_error) : 0;
	case VIDIOC_S_DV_TIMINGS:
		return device.timings_error ? refuse(device.timings_error) : 0;
	case VIDIOC_QUERYSTD:
		*(v4l2_std_id *)argument = device.detected;
		return 0;
	case VIDIOC_G_STD:
		*(v4l2_std_id *)argument = device.standard;
		return 0;
	case VIDIOC_S_STD:
		device.changes++;
		device.standard = *(v4l2_std_id *)argument;
		return 0;
	case VIDIOC_ENUMSTD:
		return enumerate_standard(argument);
	case VIDIOC_SUBSCRIBE_EVENT:
		return device.tells ? 0 : refuse(EINVAL);
	case VIDIOC_DQEVENT:
		return next_event(argument);
	case VIDIOC_QUERY_EXT_CTRL:
		return query_control(argument);
	case VIDIOC_QUERYMENU:
		return query_menu(argument);
	case VIDIOC_G_EXT_CTRLS:
		return get_control(((struct v4l2_ext_controls *)argument)->controls);
	case VIDIOC_S_EXT_CTRLS:
		return set_control(((struct v4l2_ext_controls *)argument)->controls);
	default:
		return refuse(ENOTTY);
	}
}

static int set_rate(struct v4l2_fract *interval)
{
	const unsigned wanted = interval->denominator / interval->numerator;

	device.rate = wanted > 15 && device.room == 0 ? 15 : wanted; /* it does 15 at most */
	*interval = (struct v4l2_fract){1, device.rate};
	return 0;
}

static int answer(unsigned long request, void *argument)
{
	struct v4l2_capability *capability = argument;
	struct v4l2_streamparm *parameters = argument;
	struct v4l2_buffer *buffer = argument;

	switch (request) {
	case VIDIOC_QUERYCAP:
		strcpy((char *)capability->card, "played");
		strcpy((char *)capability->bus_info, "test:1");
		capability->capabilities = V4L2_CAP_DEVICE_CAPS | V4L2_CAP_VIDEO_CAPTURE;
		capability->device_caps = V4L2_CAP_STREAMING;
		if (!device.no_capture)
			capability->device_caps |= device.multiplanar
							   ? V4L2_CAP_VIDEO_CAPTURE_MPLANE
							   : V4L2_CAP_VIDEO_CAPTURE;
		return 0;
	case VIDIOC_ENUM_FMT:
		return enumerate_format(argument);
	case VIDIOC_ENUM_FRAMESIZES:
		return enumerate_size(argument);
	case VIDIOC_ENUM_FRAMEINTERVALS:
		return enumerate_rate(argument);
	case VIDIOC_G_FMT:
		return fill_format(argument);
	case VIDIOC_S_FMT:
		assert_int_equal(device.buffers, 0);
		return take_format(argument);
	case VIDIOC_G_PARM:
		parameters->parm.capture.capability = V4L2_CAP_TIMEPERFRAME;
		parameters->parm.capture.timeperframe = (struct v4l2_fract){1, device.rate};
		return 0;
	case VIDIOC_S_PARM:
		return set_rate(&parameters->parm.capture.timeperframe);
	case VIDIOC_REQBUFS:
		return request_buffers(argument);
	case VIDIOC_QUERYBUF:
		return query_buffer(argument);
	case VIDIOC_QBUF:
		assert_false(device.queued[buffer->index]);
		device.queued[buffer->index] = true;
		return 0;
	case VIDIOC_DQBUF:
		return dequeue(argument);
	case VIDIOC_STREAMON:
		return start_streaming();
	case VIDIOC_STREAMOFF:
		device.streaming = false;
		return 0;
	default:
		return answer_source(request, argument);
	}
}

/* Other files are no V4L2 devices. */
int ioctl(int fd, unsigned long request, ...)
{
	char name[64], target[256];
	void *argument;
	va_list list;
	ssize_t length;

	va_start(list, request);
	argument = va_arg(list, void *);
	va_end(list);
	snprintf(name, sizeof(name), "/proc/self/fd/%d", fd);
	length = readlink(name, target, sizeof(target) - 1);
	target[length > 0 ? length : 0] = '\0';
	if (strcmp(target, path) != 0)
		return refuse(ENOTTY);
	if (device.interrupts > 0) {
		device.interrupts--;
		return refuse(EINTR);
	}
	return answer(request, argument);
}

/* An ordinary file cannot be waited for. */
int epoll_ctl(int epoll, int operation, int fd, struct epoll_event *event)
{
	(void)epoll;
	(void)fd;
	assert_int_equal(operation, EPOLL_CTL_ADD);
	assert_int_equal(event->events, EPOLLIN | EPOLLPRI);
	return 0;
}

static const uint32_t usual_formats[] = {V4L2_PIX_FMT_MJPEG, V4L2_PIX_FMT_NV12, V4L2_PIX_FMT_YUYV,
					 V4L2_PIX_FMT_YUV410, 0};

struct rig {
	struct camera camera;
	struct camera_settings settings;
	struct fault fault;
	struct v4l2_options options;
};

static void prepare(struct rig *rig, const uint32_t *formats)
{
	memset(rig, 0, sizeof(*rig));
	memset(&device, 0, sizeof(device));
	device.formats = formats;
	device.width = 64;
	device.height = 48;
	device.rate = 5;
	device.field = V4L2_FIELD_NONE;
	device.fourcc = formats[0];
	device.timestamp_flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
	rig->settings.buffers = 4;
	assert_int_equal(camera_v4l2.options_size, sizeof(rig->options));
	snprintf(rig->settings.device, sizeof(rig->settings.device), "%s", path);
}

static int start(struct rig *rig)
{
	return camera_open(&rig->camera, &camera_v4l2, &rig->settings, &rig->options, &rig->fault);
}

static inline void must_start(struct rig *rig)
{
	if (start(rig))
		fail_msg("%s", rig->fault.text);
	assert_true(device.streaming);
	assert_string_equal(rig->camera.name, "played");
}

static void finish(struct rig *rig)
{
	camera_close(&rig->camera);
	camera_close(&rig->camera);
	assert_false(device.streaming);
	assert_int_equal(device.buffers, 0);
}

static inline struct ready *deliver(int buffer, uint32_t sequence, uint32_t bytes, uint32_t flags)
{
	struct ready *r = &device.ready[device.ready_count++];

	*r = (struct ready){.buffer = buffer,
			    .sequence = sequence,
			    .flags = flags,
			    .field = device.field,
			    .bytes = {bytes, bytes}};
	return r;
}

static inline int queued(void)
{
	int count = 0;

	for (int i = 0; i < BUFFERS_MAX; i++)
		count += device.queued[i];
	return count;
}

static int make_file(void **state)
{
	(void)state;
	file = mkstemp(path);
	if (file < 0)
		return -1;
	for (int i = 0; i < BUFFERS_MAX * 2; i++) {
		uint8_t *block = malloc(BUFFER_BYTES);

		if (!block)
			return -1;
		memset(block, i + 1, BUFFER_BYTES);
		if (write(file, block, BUFFER_BYTES) != BUFFER_BYTES)
			return -1;
		free(block);
	}
	return 0;
}

static int remove_file(void **state)
{
	(void)state;
	close(file);
	return unlink(path);
}

#endif
