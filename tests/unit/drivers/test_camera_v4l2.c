/* SPDX-License-Identifier: MIT */
/* The V4L2 driver against a played device: formats, frames, faults. test_v4l2_digitizer.c has
 * digitizers; test_v4l2_settings.c has controls, and what is given up when the bus is full. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "drivers/v4l2/v4l2.h"
#include "hal/base/clock.h"
#include "hal/device/camera.h"
#include "tests/support/captured_log.h"
#include "tests/support/played_v4l2.h"
#include "tests/support/test.h"

enum { BUFFERS = 4 };

TEST("formats are chosen")
{
	static const uint32_t only_yuyv[] = {V4L2_PIX_FMT_YUYV, 0};
	struct played_rig rig;

	played_prepare(&rig, played_formats); /* the cheapest format that inlay reads */
	played_must_start(&rig);
	assert_int_equal(rig.camera.format, PIXEL_YUYV);
	assert_int_equal(rig.camera.width, 64);
	assert_true(rig.camera.rate_hz == 5);
	played_finish(&rig);

	played_prepare(&rig, played_formats); /* only MJPEG is fast enough */
	played.sizes_known = true;
	rig.settings.width = 64;
	rig.settings.height = 48;
	rig.settings.rate_hz = 30;
	played_must_start(&rig);
	assert_int_equal(rig.camera.format, PIXEL_MJPEG);
	assert_true(rig.camera.rate_hz == 15); /* the real rate of the device */
	played_finish(&rig);

	played_prepare(&rig, played_formats);
	rig.settings.format = PIXEL_NV12;
	played_must_start(&rig);
	assert_int_equal(rig.camera.format, PIXEL_NV12);
	played_finish(&rig);

	played_prepare(&rig, only_yuyv);
	rig.settings.format = PIXEL_NV12;
	assert_int_equal(played_start(&rig), -ENOTSUP);
	assert_int_equal(rig.camera.situation, CAMERA_UNSUPPORTED_FORMAT);
	assert_non_null(strstr(rig.fault.text, "NV12"));
	played_finish(&rig);
}

/* What a device calls Y16 may fill fewer bits: the configuration says which. */
TEST("y16 of fewer bits is declared")
{
	static const uint32_t only_y16[] = {V4L2_PIX_FMT_Y16, 0};
	static const uint32_t both[] = {V4L2_PIX_FMT_Y16, V4L2_PIX_FMT_Y12, 0};
	static const int wanted[] = {PIXEL_NONE, PIXEL_Y10, PIXEL_Y12, PIXEL_Y14, PIXEL_Y16};
	struct played_rig rig;
	struct frame frame;

	for (int i = 0; i < 5; i++) {
		played_prepare(&rig, only_y16);
		rig.settings.format = wanted[i];
		played_must_start(&rig);
		assert_int_equal(played.fourcc, V4L2_PIX_FMT_Y16);
		assert_int_equal(rig.camera.format, i ? wanted[i] : PIXEL_Y16);
		played_deliver(1, 0, 64 * 2 * 48, 0);
		assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), 0);
		assert_int_equal(frame.format, i ? wanted[i] : PIXEL_Y16);
		camera_release(&rig.camera, &frame);
		played_finish(&rig);
	}
	played_prepare(&rig, both);
	rig.settings.format = PIXEL_Y12;
	played_must_start(&rig);
	assert_int_equal(played.fourcc, V4L2_PIX_FMT_Y12);
	played_finish(&rig);
}

TEST("depths are taken where they are wanted")
{
	static const uint32_t both[] = {V4L2_PIX_FMT_Z16, V4L2_PIX_FMT_GREY, 0};
	static const uint32_t depths[] = {V4L2_PIX_FMT_Z16, 0}, none[] = {0};
	struct frame frame;
	struct played_rig rig;

	played_prepare(&rig, both);
	assert_true(v4l2_offers_kind(played_file, V4L2_BUF_TYPE_VIDEO_CAPTURE, true));
	assert_true(v4l2_offers_kind(played_file, V4L2_BUF_TYPE_VIDEO_CAPTURE, false));
	played_must_start(&rig);
	assert_int_equal(rig.camera.format, PIXEL_GREY);
	played_finish(&rig);

	played_prepare(&rig, depths);
	assert_true(v4l2_offers_kind(played_file, V4L2_BUF_TYPE_VIDEO_CAPTURE, true));
	assert_false(v4l2_offers_kind(played_file, V4L2_BUF_TYPE_VIDEO_CAPTURE, false));
	rig.settings.format = PIXEL_Z16;
	played.stride_extra = 32;
	played_must_start(&rig);
	assert_int_equal(rig.camera.format, PIXEL_Z16);
	played_deliver(1, 3, (64 * 2 + 32) * 48, 0);
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), 0);
	assert_int_equal(frame.planes[0].stride, 64 * 2 + 32);
	assert_int_equal(frame.fields, FIELDS_NONE);
	assert_int_equal(frame_check(&frame, NULL), 0);
	camera_release(&rig.camera, &frame);
	played_finish(&rig);

	played_prepare(&rig, played_formats);
	assert_false(v4l2_offers_kind(played_file, V4L2_BUF_TYPE_VIDEO_CAPTURE, true));
	rig.settings.format = PIXEL_Z16;
	assert_int_equal(played_start(&rig), -ENOTSUP);
	assert_non_null(strstr(rig.fault.text, "expected Z16"));
	played_finish(&rig);
	played_prepare(&rig, none);
	assert_true(v4l2_offers_kind(played_file, V4L2_BUF_TYPE_VIDEO_CAPTURE, false));
	assert_false(v4l2_offers_kind(played_file, V4L2_BUF_TYPE_VIDEO_CAPTURE, true));
}

TEST("frames come and go back")
{
	const int64_t now_ns = clock_now_ns(), shot_ns = now_ns - 5000000;
	struct frame frame;
	struct played_rig rig;

	played_prepare(&rig, played_formats);
	played.stride_extra = 32;
	played.interrupts = 3; /* signals do not matter */
	played_must_start(&rig);
	assert_int_equal(played_queued(), BUFFERS);
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), -EAGAIN);
	played_deliver(2, 7, (64 * 2 + 32) * 48, 0)->time_ns = shot_ns;
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), 0);
	assert_int_equal(frame.format, PIXEL_YUYV);
	assert_int_equal(frame.planes[0].stride, 64 * 2 + 32);
	assert_int_equal(frame.planes[0].bytes, (64 * 2 + 32) * 48);
	assert_int_equal(frame.planes[0].data[0], 2 * 2 + 1); /* buffer 2 */
	assert_int_equal(frame.sequence, 7);
	assert_int_equal(frame.timestamp_ns, shot_ns / 1000 * 1000);
	assert_int_equal(played_queued(), BUFFERS - 1);
	camera_release(&rig.camera, &frame);
	assert_int_equal(played_queued(), BUFFERS);
	played.timestamp_flags = V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN;
	played_deliver(0, 8, (64 * 2 + 32) * 48, 0);
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), 0);
	assert_in_range(frame.timestamp_ns, now_ns, clock_now_ns());
	camera_release(&rig.camera, &frame);
	assert_int_equal(rig.camera.lost, 0);
	played_finish(&rig);
}

/* A clock that has wrapped around, or another clock, would make latency meaningless. */
TEST("times that cannot be are replaced")
{
	const int64_t now_ns = clock_now_ns();
	const int64_t times_ns[] = {now_ns + 3600 * NS_PER_S, INT64_MAX, 1, -5 * NS_PER_S,
				    now_ns - 3600 * NS_PER_S};
	struct frame frame;
	struct played_rig rig;

	played_prepare(&rig, played_formats);
	played_must_start(&rig);
	for (uint32_t i = 0; i < sizeof(times_ns) / sizeof(times_ns[0]); i++) {
		played_deliver(0, i, PLAYED_YUYV_BYTES, 0)->time_ns = times_ns[i];
		assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), 0);
		assert_in_range(frame.timestamp_ns, now_ns, clock_now_ns());
		camera_release(&rig.camera, &frame);
	}
	played_deliver(0, 9, PLAYED_YUYV_BYTES, 0)->time_ns =
		now_ns - 10 * NS_PER_S; /* the program was stopped */
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), 0);
	assert_int_equal(frame.timestamp_ns, (now_ns - 10 * NS_PER_S) / 1000 * 1000);
	camera_release(&rig.camera, &frame);
	played_deliver(0, 10, PLAYED_YUYV_BYTES, 0)->time_ns = now_ns -
							       11 * NS_PER_S; /* a step back */
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), 0);
	assert_in_range(frame.timestamp_ns, now_ns, clock_now_ns());
	camera_release(&rig.camera, &frame);
	played_deliver(0, 11, PLAYED_YUYV_BYTES, 0)->time_ns = now_ns - 11 * NS_PER_S; /* stands */
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), 0);
	assert_true(llabs(clock_now_ns() - frame.timestamp_ns) < NS_PER_S);
	camera_release(&rig.camera, &frame);
	played_finish(&rig);
}

TEST("the newest wins")
{
	struct frame frame;
	struct played_rig rig;

	played_prepare(&rig, played_formats);
	played_must_start(&rig);
	played_deliver(0, UINT32_MAX - 1, PLAYED_YUYV_BYTES, 0);
	played_deliver(1, UINT32_MAX, PLAYED_YUYV_BYTES, 0);
	played_deliver(2, 2, PLAYED_YUYV_BYTES, 0); /* the count wrapped; 0 and 1 are missing */
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), 0);
	assert_int_equal(frame.sequence, 2);
	assert_int_equal(rig.camera.lost, 4); /* two overtaken, two never delivered */
	assert_int_equal(played_queued(), BUFFERS - 1);
	camera_release(&rig.camera, &frame);
	played_deliver(3, 0, PLAYED_YUYV_BYTES, 0); /* the driver counts anew: no frame is lost */
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), 0);
	assert_int_equal(rig.camera.lost, 4);
	assert_int_equal(rig.camera.frames, 2);
	camera_release(&rig.camera, &frame);
	played_finish(&rig);
}

TEST("unfit frames are skipped")
{
	struct captured_log log;
	char said[512] = "";
	struct frame frame;
	struct played_rig rig;
	FILE *lines;

	played_prepare(&rig, played_formats);
	played_must_start(&rig);
	log = captured_log_begin();
	played_deliver(0, 0, PLAYED_YUYV_BYTES, V4L2_BUF_FLAG_ERROR);
	played_deliver(1, 1, PLAYED_YUYV_BYTES - 1, 0);
	played_deliver(2, 2, 0, 0);
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), -EAGAIN);
	lines = captured_log_end(&log);
	assert_non_null(fgets(said, sizeof(said), lines));
	assert_non_null(strstr(said, "frames have 6143 bytes, 64x48 YUYV needs 6144"));
	assert_null(fgets(said, sizeof(said), lines)); /* once */
	fclose(lines);
	assert_int_equal(rig.camera.broken, 3);
	assert_int_equal(played_queued(), BUFFERS);
	played_deliver(0, 3, PLAYED_YUYV_BYTES, 0);
	played_deliver(1, 4, PLAYED_YUYV_BYTES, V4L2_BUF_FLAG_ERROR);
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), 0);
	assert_int_equal(frame.sequence, 3);
	assert_int_equal(rig.camera.broken, 4);
	camera_release(&rig.camera, &frame);
	played_finish(&rig);
}

/* A driver that claims more bytes than its buffer has. */
TEST("no byte beyond the buffer")
{
	static const uint32_t raw[] = {V4L2_PIX_FMT_YUYV, 0};
	struct frame frame;
	struct played_rig rig;

	played_prepare(&rig, raw);
	played_must_start(&rig);
	played_deliver(0, 0, UINT32_MAX, 0);
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), 0);
	assert_int_equal(frame.planes[0].bytes, PLAYED_BUFFER_BYTES);
	camera_release(&rig.camera, &frame);
	played_finish(&rig);
}

/* Writes into buffer 0, grabs, and restores the buffer. */
static int grab_jpeg(struct played_rig *rig, const void *bytes, size_t count, struct frame *frame)
{
	uint8_t was[256];
	int err;

	assert_int_equal(pread(played_file, was, sizeof(was), 0), sizeof(was));
	assert_int_equal(pwrite(played_file, bytes, count, 0), count);
	played_deliver(0, 0, (uint32_t)count, 0);
	err = camera_grab(&rig->camera, frame, &rig->fault);
	assert_int_equal(pwrite(played_file, was, sizeof(was), 0), sizeof(was));
	return err;
}

/* Decoding tells whether a picture is whole; only an empty buffer is no picture. */
TEST("jpeg buffers are given out as they came")
{
	static const uint32_t jpeg[] = {V4L2_PIX_FMT_MJPEG, 0};
	struct frame frame;
	struct played_rig rig;

	played_prepare(&rig, jpeg);
	played_must_start(&rig);
	assert_int_equal(grab_jpeg(&rig, "zz\xff\xd8zzzz\xff\xd9stray", 15, &frame), 0);
	assert_int_equal(frame.planes[0].bytes, 15);
	camera_release(&rig.camera, &frame);
	assert_int_equal(grab_jpeg(&rig, "", 0, &frame), -EAGAIN);
	assert_int_equal(rig.camera.broken, 1);
	camera_release(&rig.camera, &frame);
	assert_int_equal(played_queued(), BUFFERS);
	played_finish(&rig);
}

TEST("planes of their own")
{
	static const uint32_t two[] = {V4L2_PIX_FMT_NV12M, 0}, one[] = {V4L2_PIX_FMT_NV12, 0};
	struct frame frame;
	struct played_rig rig;

	played_prepare(&rig, two);
	played.multiplanar = true;
	played_must_start(&rig);
	played_deliver(1, 0, 66 * 48 + 128, 0);
	played.ready[0].data_offset = 128;
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), 0);
	assert_int_equal(frame.format, PIXEL_NV12);
	assert_int_equal(frame.planes[0].data[0], 1 * 2 + 1);
	assert_int_equal(frame.planes[1].data[0], 1 * 2 + 2);
	assert_int_equal(frame.planes[1].stride, 66);
	assert_int_equal(frame.planes[0].bytes, 66 * 48);
	camera_release(&rig.camera, &frame);
	played_finish(&rig);

	played_prepare(&rig, one); /* both in one buffer, chroma after luma */
	played_must_start(&rig);
	played_deliver(1, 0, 64 * 72, 0);
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), 0);
	assert_ptr_equal(frame.planes[1].data, frame.planes[0].data + 64 * 48);
	assert_int_equal(frame.planes[1].bytes, 64 * 24);
	camera_release(&rig.camera, &frame);
	played_deliver(1, 1, 64 * 72 - 1, 0);
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), -EAGAIN);
	assert_int_equal(rig.camera.broken, 1);
	played_finish(&rig);
}

TEST("errors are situations")
{
	static const struct {
		int err, situation;
	} cases[] = {{EBUSY, CAMERA_BUSY}, {ENOSPC, CAMERA_NO_BANDWIDTH}, {EIO, CAMERA_BROKEN}};
	static const int signals[] = {ENOLINK, ENOLCK, ERANGE};
	struct frame frame;
	struct played_rig rig;

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		played_prepare(&rig, played_formats);
		played.streamon_error = cases[i].err;
		assert_int_equal(played_start(&rig), -cases[i].err);
		assert_int_equal(rig.camera.situation, cases[i].situation);
		assert_non_null(strstr(rig.fault.text, played_path));
		assert_null(rig.camera.state);
		played_finish(&rig);
	}
	/* A processor's node refuses so, and the program must not end over it. */
	played_prepare(&rig, played_formats);
	played.streamon_error = EINVAL;
	assert_false(camera_is_hopeless(CAMERA_BROKEN, played_start(&rig)));
	played_finish(&rig);
	played_prepare(&rig, played_formats);
	played_must_start(&rig);
	played.dequeue_error = ENODEV;
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), -ENODEV);
	assert_int_equal(rig.camera.situation, CAMERA_NO_DEVICE);
	played_finish(&rig);

	for (size_t i = 0; i < sizeof(signals) / sizeof(signals[0]); i++) {
		played_prepare(&rig, played_formats);
		played.dv_timings = true;
		played.signal_error = signals[i];
		assert_int_equal(played_start(&rig), -signals[i]);
		assert_int_equal(rig.camera.situation, CAMERA_NO_SIGNAL);
		played_finish(&rig);
	}
	played_prepare(&rig, played_formats);
	played.dv_timings = true;
	played.timings_error = EINVAL;
	assert_int_equal(played_start(&rig), -ERANGE);
	assert_int_equal(rig.camera.situation, CAMERA_NO_SIGNAL);
	assert_non_null(strstr(rig.fault.text, "timings are not taken"));
	played_finish(&rig);

	played_prepare(&rig, played_formats);
	strcpy(rig.options.input, "3");
	assert_int_equal(played_start(&rig), -EINVAL);
	assert_non_null(strstr(rig.fault.text, "v4l2.input"));
	played_finish(&rig);

	played_prepare(&rig, played_formats);
	played.no_capture = true;
	assert_int_equal(played_start(&rig), -ENODEV);
	assert_non_null(strstr(rig.fault.text, "does not capture"));
	played_finish(&rig);

	assert_int_equal(camera_situation_of(-EACCES), CAMERA_NO_PERMISSION);
	assert_int_equal(camera_situation_of(-EPERM), CAMERA_NO_PERMISSION);
}

TEST("what is no camera is refused")
{
	static const struct {
		const char *device;
		int err, situation;
	} cases[] = {{"/dev/null", -ENOTTY, CAMERA_BROKEN},
		     {"/nowhere/video0", -ENOENT, CAMERA_NO_DEVICE},
		     {"no such bus", -ENODEV, CAMERA_NO_DEVICE}};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct played_rig rig;

		played_prepare(&rig, played_formats);
		snprintf(rig.settings.device, sizeof(rig.settings.device), "%s", cases[i].device);
		assert_int_equal(played_start(&rig), cases[i].err);
		assert_int_equal(rig.camera.situation, cases[i].situation);
		assert_non_null(strstr(rig.fault.text, cases[i].device));
		played_finish(&rig);
	}
}

/* The defaults of the kernel's documentation, "Colorspaces" and "Defining Colorspaces". */
TEST("colours follow the kernel")
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

TEST("settings overrule the driver")
{
	struct frame frame;
	struct played_rig rig;

	played_prepare(&rig, played_formats);
	played.colorspace = V4L2_COLORSPACE_REC709;
	rig.settings.matrix = MATRIX_BT601 + 1;
	rig.settings.range = RANGE_FULL + 1;
	played_must_start(&rig);
	played_deliver(0, 0, PLAYED_YUYV_BYTES, 0);
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), 0);
	assert_int_equal(frame.matrix, MATRIX_BT601);
	assert_int_equal(frame.range, RANGE_FULL);
	camera_release(&rig.camera, &frame);
	played_finish(&rig);
}

TEST("a stride too small is refused")
{
	struct v4l2_format format = {.type = V4L2_BUF_TYPE_VIDEO_CAPTURE};
	struct v4l2_picture picture;

	format.fmt.pix = (struct v4l2_pix_format){
		.width = 64, .height = 48, .pixelformat = V4L2_PIX_FMT_YUYV, .bytesperline = 127};
	assert_int_equal(v4l2_picture_of(&format, 0, 0, &picture, NULL), -EINVAL);
	format.fmt.pix.bytesperline = 128;
	assert_int_equal(v4l2_picture_of(&format, 0, 0, &picture, NULL), 0);
	format.fmt.pix.bytesperline = 0; /* not told */
	assert_int_equal(v4l2_picture_of(&format, 0, 0, &picture, NULL), 0);
	assert_int_equal(picture.stride[0], 128);
	format.fmt.pix.width = 0;
	assert_int_equal(v4l2_picture_of(&format, 0, 0, &picture, NULL), -EINVAL);
}

TEST_GROUP(played_make_file, played_remove_file);
