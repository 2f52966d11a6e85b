/*
 * The V4L2 driver against a device that is played by this program: an ordinary file is opened and
 * mapped, and ioctl() is answered here instead of by a kernel. What a real kernel answers is
 * tests/vm's business; this is about answers that no healthy driver gives on demand.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <errno.h>
#include <linux/videodev2.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "drivers/drivers.h"
#include "drivers/v4l2/device.h"
#include "drivers/v4l2/formats.h"
#include "hal/clock.h"

enum { BUFFERS = 4, BUFFER_BYTES = 65536, QUEUE = 16 };

/* A picture that the played device has ready. */
struct ready {
	int buffer;
	uint32_t sequence, flags, bytes[2], data_offset;
};

static struct {
	const uint32_t *formats; /* 0 at the end */
	bool multiplanar, no_capture;
	unsigned width, height, stride_extra, colorspace, encoding, quantization;
	uint32_t fourcc;
	bool sizes_known; /* one size: 64x48; fast only in MJPEG */
	int streamon_error, dequeue_error, signal_error, interrupts;
	bool dv_timings;
	bool streaming;
	bool queued[BUFFERS];
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
		.bytesperline = stride ? stride + device.stride_extra : 0,
		.colorspace = device.colorspace,
		.ycbcr_enc = device.encoding,
		.quantization = device.quantization,
	};
	return 0;
}

static int take_format(struct v4l2_format *f)
{
	device.fourcc = device.multiplanar ? f->fmt.pix_mp.pixelformat : f->fmt.pix.pixelformat;
	device.width = device.multiplanar ? f->fmt.pix_mp.width : f->fmt.pix.width;
	device.height = device.multiplanar ? f->fmt.pix_mp.height : f->fmt.pix.height;
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
	if (!device.sizes_known || f->index > 0)
		return refuse(EINVAL);
	f->type = V4L2_FRMSIZE_TYPE_DISCRETE;
	f->discrete.width = 64;
	f->discrete.height = 48;
	return 0;
}

static int enumerate_rate(struct v4l2_frmivalenum *f)
{
	if (!device.sizes_known || f->index > 0)
		return refuse(EINVAL);
	f->type = V4L2_FRMIVAL_TYPE_DISCRETE;
	f->discrete.numerator = 1;
	f->discrete.denominator = f->pixel_format == V4L2_PIX_FMT_MJPEG ? 30 : 5;
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

static int dequeue(struct v4l2_buffer *b)
{
	const struct ready r = device.ready[0];

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
	b->flags = r.flags | device.timestamp_flags;
	b->timestamp = (struct timeval){.tv_sec = 12, .tv_usec = 345678};
	b->bytesused = r.bytes[0];
	for (unsigned p = 0; device.multiplanar && p < b->length; p++) {
		b->m.planes[p].bytesused = r.bytes[p];
		b->m.planes[p].data_offset = r.data_offset;
	}
	return 0;
}

static int answer(unsigned long request, void *argument)
{
	struct v4l2_capability *capability = argument;
	struct v4l2_streamparm *parameters = argument;
	struct v4l2_buffer *buffer = argument;
	struct v4l2_input *input = argument;

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
	case VIDIOC_G_INPUT:
		*(int *)argument = 0;
		return 0;
	case VIDIOC_S_INPUT:
		return *(int *)argument == 0 ? 0 : refuse(EINVAL);
	case VIDIOC_ENUMINPUT:
		input->capabilities = device.dv_timings ? V4L2_IN_CAP_DV_TIMINGS : 0;
		return input->index == 0 ? 0 : refuse(EINVAL);
	case VIDIOC_QUERY_DV_TIMINGS:
		return device.signal_error ? refuse(device.signal_error) : 0;
	case VIDIOC_S_DV_TIMINGS:
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
		return take_format(argument);
	case VIDIOC_G_PARM:
		parameters->parm.capture.capability = V4L2_CAP_TIMEPERFRAME;
		parameters->parm.capture.timeperframe = (struct v4l2_fract){1, 5};
		return 0;
	case VIDIOC_S_PARM: /* it does 15 at most */
		parameters->parm.capture.timeperframe = (struct v4l2_fract){1, 15};
		return 0;
	case VIDIOC_REQBUFS:
		((struct v4l2_requestbuffers *)argument)->count = BUFFERS;
		return 0;
	case VIDIOC_QUERYBUF:
		return query_buffer(argument);
	case VIDIOC_QBUF:
		assert_false(device.queued[buffer->index]);
		device.queued[buffer->index] = true;
		return 0;
	case VIDIOC_DQBUF:
		return dequeue(argument);
	case VIDIOC_STREAMON:
		if (device.streamon_error)
			return refuse(device.streamon_error);
		device.streaming = true;
		return 0;
	case VIDIOC_STREAMOFF:
		device.streaming = false;
		return 0;
	default:
		return refuse(ENOTTY);
	}
}

/* Takes the place of the C library's. Other files are no V4L2 devices. */
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

static const uint32_t usual[] = {V4L2_PIX_FMT_MJPEG, V4L2_PIX_FMT_NV12, V4L2_PIX_FMT_YUYV,
				 V4L2_PIX_FMT_YUV410, 0};

struct rig {
	struct camera camera;
	struct camera_settings settings;
	struct fault fault;
	int options; /* the driver's input */
};

static void prepare(struct rig *rig, const uint32_t *formats)
{
	memset(rig, 0, sizeof(*rig));
	memset(&device, 0, sizeof(device));
	device.formats = formats;
	device.width = 64;
	device.height = 48;
	device.fourcc = formats[0];
	device.timestamp_flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
	rig->settings.buffers = 4;
	rig->options = -1;
	assert_int_equal(camera_v4l2.options_size, sizeof(rig->options));
	snprintf(rig->settings.device, sizeof(rig->settings.device), "%s", path);
}

static int start(struct rig *rig)
{
	return camera_open(&rig->camera, &camera_v4l2, &rig->settings, &rig->options, &rig->fault);
}

static void must_start(struct rig *rig)
{
	if (start(rig))
		fail_msg("%s", rig->fault.text);
	assert_true(device.streaming);
}

static void finish(struct rig *rig)
{
	camera_close(&rig->camera);
	camera_close(&rig->camera);
	assert_false(device.streaming);
}

static void deliver(int buffer, uint32_t sequence, uint32_t bytes, uint32_t flags)
{
	device.ready[device.ready_count++] = (struct ready){
		.buffer = buffer, .sequence = sequence, .flags = flags, .bytes = {bytes, bytes}};
}

static int queued(void)
{
	int count = 0;

	for (int i = 0; i < BUFFERS; i++)
		count += device.queued[i];
	return count;
}

enum { YUYV_BYTES = 64 * 48 * 2 };

static void formats_are_chosen(void **state)
{
	static const uint32_t only_yuyv[] = {V4L2_PIX_FMT_YUYV, 0};
	struct rig rig;

	(void)state;
	prepare(&rig, usual); /* the cheapest of those that we read */
	must_start(&rig);
	assert_int_equal(rig.camera.format, PIXEL_YUYV);
	assert_int_equal(rig.camera.width, 64);
	assert_true(rig.camera.rate_hz == 5);
	finish(&rig);

	prepare(&rig, usual); /* only MJPEG is fast enough */
	device.sizes_known = true;
	rig.settings.width = 64;
	rig.settings.height = 48;
	rig.settings.rate_hz = 30;
	must_start(&rig);
	assert_int_equal(rig.camera.format, PIXEL_MJPEG);
	assert_true(rig.camera.rate_hz == 15); /* what it really does */
	finish(&rig);

	prepare(&rig, usual);
	rig.settings.format = PIXEL_NV12;
	must_start(&rig);
	assert_int_equal(rig.camera.format, PIXEL_NV12);
	finish(&rig);

	prepare(&rig, only_yuyv);
	rig.settings.format = PIXEL_NV12;
	assert_int_equal(start(&rig), -ENOTSUP);
	assert_int_equal(rig.camera.situation, CAMERA_UNSUPPORTED_FORMAT);
	assert_non_null(strstr(rig.fault.text, "NV12"));
	finish(&rig);
}

static void frames_come_and_go_back(void **state)
{
	struct frame frame;
	struct rig rig;

	(void)state;
	prepare(&rig, usual);
	device.stride_extra = 32;
	device.interrupts = 3; /* signals do no harm */
	must_start(&rig);
	assert_int_equal(queued(), BUFFERS);
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), -EAGAIN);
	deliver(2, 7, (64 * 2 + 32) * 48, 0);
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), 0);
	assert_int_equal(frame.format, PIXEL_YUYV);
	assert_int_equal(frame.planes[0].stride, 64 * 2 + 32);
	assert_int_equal(frame.planes[0].bytes, (64 * 2 + 32) * 48);
	assert_int_equal(frame.planes[0].data[0], 2 * 2 + 1); /* of buffer 2 */
	assert_int_equal(frame.sequence, 7);
	assert_int_equal(frame.timestamp_ns, INT64_C(12345678000));
	assert_int_equal(queued(), BUFFERS - 1);
	camera_release(&rig.camera, &frame);
	assert_int_equal(queued(), BUFFERS);
	device.timestamp_flags = V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN;
	deliver(0, 8, (64 * 2 + 32) * 48, 0);
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), 0);
	assert_true(llabs(clock_now_ns() - frame.timestamp_ns) < NS_PER_S);
	camera_release(&rig.camera, &frame);
	assert_int_equal(rig.camera.lost, 0);
	finish(&rig);
}

static void the_newest_wins(void **state)
{
	struct frame frame;
	struct rig rig;

	(void)state;
	prepare(&rig, usual);
	must_start(&rig);
	deliver(0, UINT32_MAX - 1, YUYV_BYTES, 0);
	deliver(1, UINT32_MAX, YUYV_BYTES, 0);
	deliver(2, 2, YUYV_BYTES, 0); /* the count wrapped; 0 and 1 are missing */
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), 0);
	assert_int_equal(frame.sequence, 2);
	assert_int_equal(rig.camera.lost, 4); /* two overtaken, two never seen */
	assert_int_equal(queued(), BUFFERS - 1);
	camera_release(&rig.camera, &frame);
	deliver(3, 0, YUYV_BYTES, 0); /* the driver counts anew: nothing is lost */
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), 0);
	assert_int_equal(rig.camera.lost, 4);
	assert_int_equal(rig.camera.frames, 2);
	camera_release(&rig.camera, &frame);
	finish(&rig);
}

static void unfit_frames_are_skipped(void **state)
{
	struct frame frame;
	struct rig rig;

	(void)state;
	prepare(&rig, usual);
	must_start(&rig);
	deliver(0, 0, YUYV_BYTES, V4L2_BUF_FLAG_ERROR);
	deliver(1, 1, YUYV_BYTES - 1, 0);
	deliver(2, 2, 0, 0);
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), -EAGAIN);
	assert_int_equal(rig.camera.broken, 3);
	assert_int_equal(queued(), BUFFERS);
	deliver(0, 3, YUYV_BYTES, 0);
	deliver(1, 4, YUYV_BYTES, V4L2_BUF_FLAG_ERROR);
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), 0);
	assert_int_equal(frame.sequence, 3);
	assert_int_equal(rig.camera.broken, 4);
	camera_release(&rig.camera, &frame);
	finish(&rig);
}

/* A driver that claims more bytes than its buffer has. */
static void no_byte_beyond_the_buffer(void **state)
{
	static const uint32_t jpeg[] = {V4L2_PIX_FMT_MJPEG, 0};
	struct frame frame;
	struct rig rig;

	(void)state;
	prepare(&rig, jpeg);
	must_start(&rig);
	deliver(0, 0, UINT32_MAX, 0);
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), 0);
	assert_int_equal(frame.planes[0].bytes, BUFFER_BYTES);
	camera_release(&rig.camera, &frame);
	finish(&rig);
}

static void planes_of_their_own(void **state)
{
	static const uint32_t two[] = {V4L2_PIX_FMT_NV12M, 0}, one[] = {V4L2_PIX_FMT_NV12, 0};
	struct frame frame;
	struct rig rig;

	(void)state;
	prepare(&rig, two);
	device.multiplanar = true;
	must_start(&rig);
	deliver(1, 0, 66 * 48 + 128, 0);
	device.ready[0].data_offset = 128;
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), 0);
	assert_int_equal(frame.format, PIXEL_NV12);
	assert_int_equal(frame.planes[0].data[0], 1 * 2 + 1);
	assert_int_equal(frame.planes[1].data[0], 1 * 2 + 2);
	assert_int_equal(frame.planes[1].stride, 66);
	assert_int_equal(frame.planes[0].bytes, 66 * 48);
	camera_release(&rig.camera, &frame);
	finish(&rig);

	prepare(&rig, one); /* both in one buffer, chroma after luma */
	must_start(&rig);
	deliver(1, 0, 64 * 72, 0);
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), 0);
	assert_ptr_equal(frame.planes[1].data, frame.planes[0].data + 64 * 48);
	assert_int_equal(frame.planes[1].bytes, 64 * 24);
	camera_release(&rig.camera, &frame);
	deliver(1, 1, 64 * 72 - 1, 0);
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), -EAGAIN);
	assert_int_equal(rig.camera.broken, 1);
	finish(&rig);
}

static void errors_are_situations(void **state)
{
	static const struct {
		int err, situation;
	} cases[] = {{EBUSY, CAMERA_BUSY}, {ENOSPC, CAMERA_NO_BANDWIDTH}, {EIO, CAMERA_BROKEN}};
	struct frame frame;
	struct rig rig;

	(void)state;
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		prepare(&rig, usual);
		device.streamon_error = cases[i].err;
		assert_int_equal(start(&rig), -cases[i].err);
		assert_int_equal(rig.camera.situation, cases[i].situation);
		assert_non_null(strstr(rig.fault.text, path));
		assert_null(rig.camera.state);
		finish(&rig);
	}
	prepare(&rig, usual);
	must_start(&rig);
	device.dequeue_error = ENODEV;
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), -ENODEV);
	assert_int_equal(rig.camera.situation, CAMERA_NO_DEVICE);
	finish(&rig);

	prepare(&rig, usual);
	device.dv_timings = true;
	device.signal_error = ENOLINK;
	assert_int_equal(start(&rig), -ENOLINK);
	assert_int_equal(rig.camera.situation, CAMERA_NO_SIGNAL);
	finish(&rig);

	prepare(&rig, usual);
	rig.options = 3;
	assert_int_equal(start(&rig), -EINVAL);
	assert_non_null(strstr(rig.fault.text, "v4l2.input"));
	finish(&rig);

	prepare(&rig, usual);
	device.no_capture = true;
	assert_int_equal(start(&rig), -ENODEV);
	assert_non_null(strstr(rig.fault.text, "does not capture"));
	finish(&rig);

	assert_int_equal(device_situation(-EACCES), CAMERA_NO_PERMISSION);
	assert_int_equal(device_situation(-EPERM), CAMERA_NO_PERMISSION);
}

static void what_is_no_camera_is_refused(void **state)
{
	static const struct {
		const char *device;
		int err, situation;
	} cases[] = {{"/dev/null", -ENOTTY, CAMERA_BROKEN},
		     {"/nowhere/video0", -ENOENT, CAMERA_NO_DEVICE},
		     {"no such bus", -ENODEV, CAMERA_NO_DEVICE}};

	(void)state;
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct rig rig;

		prepare(&rig, usual);
		snprintf(rig.settings.device, sizeof(rig.settings.device), "%s", cases[i].device);
		assert_int_equal(start(&rig), cases[i].err);
		assert_int_equal(rig.camera.situation, cases[i].situation);
		assert_non_null(strstr(rig.fault.text, cases[i].device));
		finish(&rig);
	}
}

/* The defaults of the kernel's documentation, "Colorspaces" and "Defining Colorspaces". */
static void colours_follow_the_kernel(void **state)
{
	static const struct {
		uint32_t fourcc, colorspace, encoding, quantization, height;
		int matrix, range;
	} cases[] = {
		{V4L2_PIX_FMT_YUYV, V4L2_COLORSPACE_SRGB, 0, 0, 480, MATRIX_BT601, RANGE_LIMITED},
		{V4L2_PIX_FMT_YUYV, V4L2_COLORSPACE_SMPTE170M, 0, 0, 480, MATRIX_BT601,
		 RANGE_LIMITED},
		{V4L2_PIX_FMT_NV12, V4L2_COLORSPACE_REC709, 0, 0, 720, MATRIX_BT709, RANGE_LIMITED},
		{V4L2_PIX_FMT_YUYV, V4L2_COLORSPACE_JPEG, 0, 0, 480, MATRIX_BT601, RANGE_FULL},
		{V4L2_PIX_FMT_YUYV, V4L2_COLORSPACE_REC709, V4L2_YCBCR_ENC_601,
		 V4L2_QUANTIZATION_FULL_RANGE, 720, MATRIX_BT601, RANGE_FULL},
		{V4L2_PIX_FMT_YUYV, 0, 0, 0, 480, MATRIX_BT601, RANGE_LIMITED},
		{V4L2_PIX_FMT_YUYV, 0, 0, 0, 720, MATRIX_BT709, RANGE_LIMITED},
		{V4L2_PIX_FMT_UYVY, V4L2_COLORSPACE_BT2020, 0, 0, 2160, MATRIX_BT709,
		 RANGE_LIMITED},
		{V4L2_PIX_FMT_GREY, V4L2_COLORSPACE_SRGB, 0, 0, 480, MATRIX_BT601, RANGE_FULL},
	};

	(void)state;
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		const struct v4l2_pix_format format = {.pixelformat = cases[i].fourcc,
						       .height = cases[i].height,
						       .colorspace = cases[i].colorspace,
						       .ycbcr_enc = cases[i].encoding,
						       .quantization = cases[i].quantization};
		enum colour_matrix matrix;
		enum colour_range range;

		v4l2_colours(&format, &matrix, &range);
		assert_int_equal(matrix, cases[i].matrix);
		assert_int_equal(range, cases[i].range);
	}
}

static void settings_overrule_the_driver(void **state)
{
	struct frame frame;
	struct rig rig;

	(void)state;
	prepare(&rig, usual);
	device.colorspace = V4L2_COLORSPACE_REC709;
	rig.settings.matrix = MATRIX_BT601 + 1;
	rig.settings.range = RANGE_FULL + 1;
	must_start(&rig);
	deliver(0, 0, YUYV_BYTES, 0);
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), 0);
	assert_int_equal(frame.matrix, MATRIX_BT601);
	assert_int_equal(frame.range, RANGE_FULL);
	camera_release(&rig.camera, &frame);
	finish(&rig);
}

static void a_stride_too_small_is_refused(void **state)
{
	struct v4l2_format format = {.type = V4L2_BUF_TYPE_VIDEO_CAPTURE};
	struct v4l2_picture picture;

	(void)state;
	format.fmt.pix = (struct v4l2_pix_format){
		.width = 64, .height = 48, .pixelformat = V4L2_PIX_FMT_YUYV, .bytesperline = 127};
	assert_int_equal(v4l2_picture_of(&format, &picture), -EINVAL);
	format.fmt.pix.bytesperline = 128;
	assert_int_equal(v4l2_picture_of(&format, &picture), 0);
	format.fmt.pix.width = 0;
	assert_int_equal(v4l2_picture_of(&format, &picture), -EINVAL);
	format.fmt.pix.width = 64;
	format.fmt.pix.field = V4L2_FIELD_ALTERNATE;
	assert_int_equal(v4l2_picture_of(&format, &picture), -ENOTSUP);
}

/* Each plane's memory begins with a number of its own. */
static int make_file(void **state)
{
	(void)state;
	file = mkstemp(path);
	if (file < 0)
		return -1;
	for (int i = 0; i < BUFFERS * 2; i++) {
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

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(formats_are_chosen),
		cmocka_unit_test(frames_come_and_go_back),
		cmocka_unit_test(the_newest_wins),
		cmocka_unit_test(unfit_frames_are_skipped),
		cmocka_unit_test(no_byte_beyond_the_buffer),
		cmocka_unit_test(planes_of_their_own),
		cmocka_unit_test(errors_are_situations),
		cmocka_unit_test(what_is_no_camera_is_refused),
		cmocka_unit_test(colours_follow_the_kernel),
		cmocka_unit_test(settings_overrule_the_driver),
		cmocka_unit_test(a_stride_too_small_is_refused),
	};

	return cmocka_run_group_tests_name("camera_v4l2", tests, make_file, remove_file);
}
