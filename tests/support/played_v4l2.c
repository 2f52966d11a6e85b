/* SPDX-License-Identifier: MIT */
#include "tests/support/played_v4l2.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "drivers/drivers.h"
#include "drivers/v4l2/v4l2.h"
#include "hal/base/clock.h"

struct played_device played;
char played_path[] = "/tmp/inlay-v4l2.XXXXXX";
int played_file = -1;

static int played_refuse(int err)
{
	errno = err;
	return -1;
}

static int played_fill_format(struct v4l2_format *f)
{
	const struct v4l2_layout *layout = v4l2_layout_of(played.fourcc);
	const unsigned stride =
		layout ? (unsigned)frame_plane_stride(layout->format, 0, (int)played.width) : 0;

	if (played.multiplanar) {
		struct v4l2_pix_format_mplane *m = &f->fmt.pix_mp;

		m->width = played.width;
		m->height = played.height;
		m->pixelformat = played.fourcc;
		m->field = played.field;
		m->num_planes = (uint8_t)(layout ? layout->memory_planes : 1);
		m->colorspace = played.colorspace;
		m->plane_fmt[0].bytesperline = stride + played.stride_extra;
		m->plane_fmt[1].bytesperline = stride + played.stride_extra + 2;
		return 0;
	}
	f->fmt.pix = (struct v4l2_pix_format){
		.width = played.width,
		.height = played.height,
		.pixelformat = played.fourcc,
		.field = played.field,
		.bytesperline = stride ? stride + played.stride_extra : 0,
		.colorspace = played.colorspace,
		.ycbcr_enc = played.encoding,
		.quantization = played.quantization,
	};
	return 0;
}

static bool played_room_is_short(void)
{
	return played.room > 0 &&
	       (double)v4l2_bits(played.fourcc) * played.width * played.height * played.rate >
		       played.room;
}

/* Television is sent in the field order that is asked for, anything else progressive. */
static int played_take_format(struct v4l2_format *f)
{
	const uint32_t asked = played.multiplanar ? f->fmt.pix_mp.field : f->fmt.pix.field;

	played.fourcc = played.multiplanar ? f->fmt.pix_mp.pixelformat : f->fmt.pix.pixelformat;
	played.width = played.multiplanar ? f->fmt.pix_mp.width : f->fmt.pix.width;
	played.height = played.multiplanar ? f->fmt.pix_mp.height : f->fmt.pix.height;
	if (played.television)
		played.field = asked == V4L2_FIELD_ANY ? V4L2_FIELD_INTERLACED : asked;
	if (played.room_at_format && played_room_is_short())
		return played_refuse(ENOSPC);
	return played_fill_format(f);
}

static int played_enumerate_format(struct v4l2_fmtdesc *f)
{
	for (unsigned i = 0; played.formats[i]; i++)
		if (i == f->index) {
			f->pixelformat = played.formats[i];
			return 0;
		}
	return played_refuse(EINVAL);
}

static int played_enumerate_size(struct v4l2_frmsizeenum *f)
{
	if (!played.sizes_known || f->index > 1)
		return played_refuse(EINVAL);
	f->type = V4L2_FRMSIZE_TYPE_DISCRETE;
	f->discrete.width = f->index ? 32 : 64;
	f->discrete.height = f->index ? 24 : 48;
	return 0;
}

/* MJPEG at 30, 15 and 5 a second, others at 5. */
static int played_enumerate_rate(struct v4l2_frmivalenum *f)
{
	static const unsigned rates[] = {30, 15, 5};
	const unsigned first = f->pixel_format == V4L2_PIX_FMT_MJPEG ? 0 : 2;

	if (!played.sizes_known || f->index + first > 2)
		return played_refuse(EINVAL);
	f->type = V4L2_FRMIVAL_TYPE_DISCRETE;
	f->discrete.numerator = 1;
	f->discrete.denominator = rates[first + f->index];
	return 0;
}

static int played_query_buffer(struct v4l2_buffer *b)
{
	const unsigned planes = played.multiplanar ? b->length : 1;

	if (!played.multiplanar) {
		b->length = PLAYED_BUFFER_BYTES;
		b->m.offset = b->index * 2 * PLAYED_BUFFER_BYTES;
		return 0;
	}
	for (unsigned p = 0; p < planes; p++) {
		b->m.planes[p].length = PLAYED_BUFFER_BYTES;
		b->m.planes[p].m.mem_offset = (b->index * 2 + p) * PLAYED_BUFFER_BYTES;
	}
	return 0;
}

static int played_request_buffers(struct v4l2_requestbuffers *r)
{
	assert_false(played.streaming);
	if (played.held)
		return played_refuse(EBUSY);
	if (r->count > PLAYED_BUFFERS_MAX)
		r->count = PLAYED_BUFFERS_MAX;
	played.buffers = (int)r->count;
	memset(played.queued, 0, sizeof(played.queued));
	return 0;
}

static int played_dequeue(struct v4l2_buffer *b)
{
	const struct played_picture r = played.ready[0];
	const int64_t time_ns = r.time_ns ? r.time_ns : clock_now_ns();

	if (played.dequeue_error)
		return played_refuse(played.dequeue_error);
	if (played.ready_count == 0)
		return played_refuse(EAGAIN);
	memmove(played.ready, played.ready + 1, sizeof(played.ready) - sizeof(played.ready[0]));
	played.ready_count--;
	assert_true(played.queued[r.buffer]);
	played.queued[r.buffer] = false;
	b->index = (unsigned)r.buffer;
	b->sequence = r.sequence;
	b->field = r.field;
	b->flags = r.flags | played.timestamp_flags;
	b->timestamp = (struct timeval){.tv_sec = time_ns / NS_PER_S,
					.tv_usec = time_ns % NS_PER_S / 1000};
	b->bytesused = r.bytes[0];
	for (unsigned p = 0; played.multiplanar && p < b->length; p++) {
		b->m.planes[p].bytesused = r.bytes[p];
		b->m.planes[p].data_offset = r.data_offset;
	}
	return 0;
}

static int played_start_streaming(void)
{
	if (played.streamon_error)
		return played_refuse(played.streamon_error);
	if (played_room_is_short())
		return played_refuse(ENOSPC);
	if (played.resets)
		played.controls[0].value = played.controls[0].minimum;
	played.streaming = true;
	return 0;
}

/* ---- inputs ---- */

static int played_enumerate_input(struct v4l2_input *input)
{
	static const char *const names[] = {"Composite 0", "S-Video"};

	if (input->index > 1)
		return played_refuse(EINVAL);
	snprintf((char *)input->name, sizeof(input->name), "%s", names[input->index]);
	input->capabilities = (played.dv_timings ? V4L2_IN_CAP_DV_TIMINGS : 0) |
			      (played.television ? V4L2_IN_CAP_STD : 0);
	input->std = played.television ? V4L2_STD_PAL_BG | V4L2_STD_NTSC_M : 0;
	input->status = played.status;
	return 0;
}

static int played_enumerate_standard(struct v4l2_standard *s)
{
	static const struct {
		const char *name;
		v4l2_std_id id;
	} listed[] = {{"NTSC-M", V4L2_STD_NTSC_M}, {"PAL-BG", V4L2_STD_PAL_BG}};

	if (!played.television || s->index > 1)
		return played_refuse(EINVAL);
	snprintf((char *)s->name, sizeof(s->name), "%s", listed[s->index].name);
	s->id = listed[s->index].id;
	return 0;
}

static int played_next_event(struct v4l2_event *event)
{
	if (played.events == 0)
		return played_refuse(ENOENT);
	event->type = V4L2_EVENT_SOURCE_CHANGE;
	event->pending = (unsigned)--played.events;
	return 0;
}

/* ---- controls ---- */

static struct played_control *played_control_of(uint32_t id)
{
	struct played_control *c = &played.controls[(id - PLAYED_CONTROL) % PLAYED_CONTROLS_MAX];

	return id >= PLAYED_CONTROL && id < PLAYED_CONTROL + PLAYED_CONTROLS_MAX && c->name ? c
											    : NULL;
}

static int played_query_control(struct v4l2_query_ext_ctrl *query)
{
	const bool next = query->id & V4L2_CTRL_FLAG_NEXT_CTRL;
	const uint32_t asked = query->id & ~(uint32_t)V4L2_CTRL_FLAG_NEXT_CTRL;
	const uint32_t id = !next ? asked : asked < PLAYED_CONTROL ? PLAYED_CONTROL : asked + 1;
	const struct played_control *c = played_control_of(id);

	if (!c)
		return played_refuse(EINVAL);
	*query = (struct v4l2_query_ext_ctrl){.id = id,
					      .type = c->type,
					      .minimum = c->minimum,
					      .maximum = c->maximum,
					      .flags = c->flags,
					      .elems = 1};
	snprintf(query->name, sizeof(query->name), "%s", c->name);
	return 0;
}

static int played_query_menu(struct v4l2_querymenu *menu)
{
	static const char *const entries[] = {"Disabled", "50 Hz", "60 Hz"};

	if (menu->index > 2)
		return played_refuse(EINVAL);
	snprintf((char *)menu->name, sizeof(menu->name), "%s", entries[menu->index]);
	return 0;
}

static int played_get_control(struct v4l2_ext_control *one)
{
	const struct played_control *c = played_control_of(one->id);

	if (!c)
		return played_refuse(EINVAL);
	one->value = c->value;
	return 0;
}

static int played_set_control(const struct v4l2_ext_control *one)
{
	struct played_control *c = played_control_of(one->id);

	if (!c || c->refuse)
		return played_refuse(c ? c->refuse : EINVAL);
	if (one->value < c->minimum || one->value > c->maximum)
		return played_refuse(ERANGE);
	c->value = c->most && one->value > c->most ? c->most : one->value;
	if (c->step)
		c->value = (c->value + c->step / 2) / c->step * c->step;
	c->sets++;
	return 0;
}

/* ---- calls ---- */

static int played_answer_source(unsigned long request, void *argument)
{
	switch (request) {
	case VIDIOC_G_INPUT:
		*(int *)argument = played.input;
		return 0;
	case VIDIOC_S_INPUT:
		played.changes++;
		played.input = *(int *)argument;
		return played.input < 2 ? 0 : played_refuse(EINVAL);
	case VIDIOC_ENUMINPUT:
		return played_enumerate_input(argument);
	case VIDIOC_QUERY_DV_TIMINGS:
		return played.signal_error ? played_refuse(played.signal_error) : 0;
	case VIDIOC_S_DV_TIMINGS:
		return played.timings_error ? played_refuse(played.timings_error) : 0;
	case VIDIOC_QUERYSTD:
		*(v4l2_std_id *)argument = played.detected;
		return 0;
	case VIDIOC_G_STD:
		*(v4l2_std_id *)argument = played.standard;
		return 0;
	case VIDIOC_S_STD:
		played.changes++;
		played.standard = *(v4l2_std_id *)argument;
		return 0;
	case VIDIOC_ENUMSTD:
		return played_enumerate_standard(argument);
	case VIDIOC_SUBSCRIBE_EVENT:
		return played.tells ? 0 : played_refuse(EINVAL);
	case VIDIOC_DQEVENT:
		return played_next_event(argument);
	case VIDIOC_QUERY_EXT_CTRL:
		return played_query_control(argument);
	case VIDIOC_QUERYMENU:
		return played_query_menu(argument);
	case VIDIOC_G_EXT_CTRLS:
		return played_get_control(((struct v4l2_ext_controls *)argument)->controls);
	case VIDIOC_S_EXT_CTRLS:
		return played_set_control(((struct v4l2_ext_controls *)argument)->controls);
	default:
		return played_refuse(ENOTTY);
	}
}

static int played_set_rate(struct v4l2_fract *interval)
{
	const unsigned wanted = interval->denominator / interval->numerator;

	played.rate = wanted > 15 && played.room == 0 ? 15 : wanted; /* 15 Hz at most */
	*interval = (struct v4l2_fract){1, played.rate};
	return 0;
}

static int played_answer(unsigned long request, void *argument)
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
		if (!played.no_capture)
			capability->device_caps |= played.multiplanar
							   ? V4L2_CAP_VIDEO_CAPTURE_MPLANE
							   : V4L2_CAP_VIDEO_CAPTURE;
		return 0;
	case VIDIOC_ENUM_FMT:
		return played_enumerate_format(argument);
	case VIDIOC_ENUM_FRAMESIZES:
		return played_enumerate_size(argument);
	case VIDIOC_ENUM_FRAMEINTERVALS:
		return played_enumerate_rate(argument);
	case VIDIOC_G_FMT:
		return played_fill_format(argument);
	case VIDIOC_S_FMT:
		assert_int_equal(played.buffers, 0);
		return played_take_format(argument);
	case VIDIOC_G_PARM:
		parameters->parm.capture.capability = V4L2_CAP_TIMEPERFRAME;
		parameters->parm.capture.timeperframe = (struct v4l2_fract){1, played.rate};
		return 0;
	case VIDIOC_S_PARM:
		return played_set_rate(&parameters->parm.capture.timeperframe);
	case VIDIOC_REQBUFS:
		return played_request_buffers(argument);
	case VIDIOC_QUERYBUF:
		return played_query_buffer(argument);
	case VIDIOC_QBUF:
		assert_false(played.queued[buffer->index]);
		played.queued[buffer->index] = true;
		return 0;
	case VIDIOC_DQBUF:
		return played_dequeue(argument);
	case VIDIOC_STREAMON:
		return played_start_streaming();
	case VIDIOC_STREAMOFF:
		played.streaming = false;
		return 0;
	default:
		return played_answer_source(request, argument);
	}
}

/* In place of ioctl(). Only the played file is a V4L2 device. */
int __wrap_ioctl(int fd, unsigned long request, ...);

int __wrap_ioctl(int fd, unsigned long request, ...)
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
	if (strcmp(target, played_path) != 0)
		return played_refuse(ENOTTY);
	if (played.interrupts > 0) {
		played.interrupts--;
		return played_refuse(EINTR);
	}
	return played_answer(request, argument);
}

/* In place of epoll_ctl(), because epoll refuses ordinary files. */
int __wrap_epoll_ctl(int epoll, int operation, int fd, struct epoll_event *event);

int __wrap_epoll_ctl(int epoll, int operation, int fd, struct epoll_event *event)
{
	(void)epoll;
	(void)fd;
	assert_int_equal(operation, EPOLL_CTL_ADD);
	assert_int_equal(event->events, EPOLLIN | EPOLLPRI);
	return 0;
}

const uint32_t played_formats[] = {V4L2_PIX_FMT_MJPEG, V4L2_PIX_FMT_NV12, V4L2_PIX_FMT_YUYV,
				   V4L2_PIX_FMT_YUV410, 0};

void played_prepare(struct played_rig *rig, const uint32_t *formats)
{
	memset(rig, 0, sizeof(*rig));
	memset(&played, 0, sizeof(played));
	played.formats = formats;
	played.width = 64;
	played.height = 48;
	played.rate = 5;
	played.field = V4L2_FIELD_NONE;
	played.fourcc = formats[0];
	played.timestamp_flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
	rig->settings.buffers = 4;
	assert_int_equal(camera_v4l2.options_size, sizeof(rig->options));
	snprintf(rig->settings.device, sizeof(rig->settings.device), "%s", played_path);
}

int played_start(struct played_rig *rig)
{
	return camera_open(&rig->camera, &camera_v4l2, &rig->settings, &rig->options, &rig->fault);
}

void played_must_start(struct played_rig *rig)
{
	if (played_start(rig))
		fail_msg("%s", rig->fault.text);
	assert_true(played.streaming);
	assert_string_equal(rig->camera.name, "played");
}

void played_finish(struct played_rig *rig)
{
	camera_close(&rig->camera);
	camera_close(&rig->camera);
	assert_false(played.streaming);
	assert_int_equal(played.buffers, 0);
}

struct played_picture *played_deliver(int buffer, uint32_t sequence, uint32_t bytes, uint32_t flags)
{
	struct played_picture *r = &played.ready[played.ready_count++];

	*r = (struct played_picture){.buffer = buffer,
				     .sequence = sequence,
				     .flags = flags,
				     .field = played.field,
				     .bytes = {bytes, bytes}};
	return r;
}

int played_queued(void)
{
	int count = 0;

	for (int i = 0; i < PLAYED_BUFFERS_MAX; i++)
		count += played.queued[i];
	return count;
}

int played_make_file(void **state)
{
	(void)state;
	played_file = mkstemp(played_path);
	if (played_file < 0)
		return -1;
	for (int i = 0; i < PLAYED_BUFFERS_MAX * 2; i++) {
		uint8_t *block = malloc(PLAYED_BUFFER_BYTES);

		if (!block)
			return -1;
		memset(block, i + 1, PLAYED_BUFFER_BYTES);
		if (write(played_file, block, PLAYED_BUFFER_BYTES) != PLAYED_BUFFER_BYTES)
			return -1;
		free(block);
	}
	return 0;
}

int played_remove_file(void **state)
{
	(void)state;
	close(played_file);
	return unlink(played_path);
}
