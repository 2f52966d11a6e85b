/* SPDX-License-Identifier: MIT */
/* A camera as the program uses it, driven by a fake camera that the test controls. */
#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/eventfd.h>
#include <turbojpeg.h>
#include <unistd.h>

#include "app/camera/eye.h"
#include "app/camera/source.h"
#include "hal/base/clock.h"
#include "hal/device/camera.h"
#include "tests/support/test.h"

/* What the fake camera does next, and what was done to it. */
static struct {
	int open_err, grab_err;
	enum camera_situation situation;
	bool on_demand;
	double rate_hz;
	enum pixel_format format;
	int width, height;
	size_t bytes; /* readable bytes; 0: the whole frame */
	/* An eventfd: opening waits until the test writes to it; 0: opening does not wait. */
	int gate;
	const char *name;
	uint8_t level;
	float linear[3];
	uint8_t jpeg[4096];
	unsigned long jpeg_bytes;
	int opened, closed, out; /* out: frames not given back yet */
	uint32_t sequence;
} fake;

/* Frames alternate between these, like buffers of a driver. */
static uint8_t buffers[2][64 * 64 * 12];

static int fake_open(struct camera *camera, struct fault *fault)
{
	eventfd_t opened;

	if (fake.gate)
		(void)eventfd_read(fake.gate, &opened);
	if (fake.open_err) {
		camera->situation = fake.situation;
		return fault_say(fault, fake.open_err, "fake: it is broken");
	}
	fake.opened++;
	snprintf(camera->name, sizeof(camera->name), "%s", fake.name ? fake.name : "");
	camera->format = fake.format;
	camera->width = fake.width;
	camera->height = fake.height;
	camera->on_demand = fake.on_demand;
	camera->rate_hz = fake.rate_hz;
	camera->state = &fake;
	return 0;
}

static int fake_descriptor(struct camera *camera)
{
	(void)camera;
	return 42;
}

static int fake_grab(struct camera *camera, struct frame *frame, struct fault *fault)
{
	size_t stride = frame_plane_stride(fake.format, 0, fake.width);
	uint8_t *memory = buffers[fake.sequence % 2];

	if (fake.grab_err) {
		camera->situation = fake.situation;
		return fault_say(fault, fake.grab_err, "fake: it is gone");
	}
	assert_int_equal(fake.out, 0);
	fake.out++;
	memset(memory, fake.level, sizeof(buffers[0]));
	if (fake.format == PIXEL_RGBF) {
		for (int i = 0; i < fake.width * fake.height; i++)
			memcpy(memory + 12 * i, fake.linear, 12);
	}
	*frame = (struct frame){
		.format = fake.format,
		.width = fake.width,
		.height = fake.height,
		.range = RANGE_FULL,
		.timestamp_ns = 1000 + fake.sequence,
		.sequence = fake.sequence,
	};
	fake.sequence++;
	frame->planes[0] = (struct frame_plane){
		memory, stride, fake.bytes ? fake.bytes : stride * (size_t)fake.height};
	if (fake.format == PIXEL_MJPEG)
		frame->planes[0] = (struct frame_plane){fake.jpeg, 0, fake.jpeg_bytes};
	return 0;
}

static void fake_release(struct camera *camera, struct frame *frame)
{
	(void)camera;
	(void)frame;
	fake.out--;
	assert_int_equal(fake.out, 0);
}

static void fake_close(struct camera *camera)
{
	if (camera->state)
		fake.closed++;
	camera->state = NULL;
}

static const struct camera_ops fake_ops = {
	.name = "fake",
	.description = "does what the test says",
	.open = fake_open,
	.descriptor = fake_descriptor,
	.grab = fake_grab,
	.release = fake_release,
	.close = fake_close,
};

static struct source source;

static int test_source_begin(void **state)
{
	struct source_settings settings = {
		.name = "front", .ops = &fake_ops, .curve = {.named = TRANSFER_SRGB}};

	(void)state;
	memset(&fake, 0, sizeof(fake));
	fake.format = PIXEL_BGRX;
	fake.width = 16;
	fake.height = 8;
	fake.level = 100;
	return source_create(&source, &settings);
}

static int test_source_end(void **state)
{
	(void)state;
	source_destroy(&source);
	source_destroy(&source);
	return fake.out || fake.opened != fake.closed;
}

static struct fault told;

/* What opening the source returned. */
static int opened(void)
{
	struct pollfd end;

	source_open(&source);
	assert_false(source_is_open(&source));
	end = (struct pollfd){.fd = source_descriptor(&source), .events = POLLIN};
	assert_int_equal(poll(&end, 1, 60000), 1);
	return source_take(&source, clock_now_ns(), &told);
}

static void must_open(void)
{
	assert_int_equal(opened(), 0);
	assert_true(source_is_open(&source));
}

static void test_source_take(int64_t now_ns)
{
	assert_int_equal(source_take(&source, now_ns, &told), 0);
}

/* The camera has gone: the source closes it. */
static void must_close(void)
{
	int before = fake.grab_err;

	fake.grab_err = -ENODEV;
	test_source_take(1);
	assert_false(source_is_open(&source));
	fake.grab_err = before;
}

TEST_BETWEEN("newest frame is held", test_source_begin, test_source_end)
{
	must_open();
	assert_false(source_has_news(&source));
	assert_false(source_has_picture(&source));
	test_source_take(5);
	test_source_take(6);
	fake.level = 33;
	test_source_take(7);
	assert_true(source_has_news(&source));
	assert_int_equal(source_counts(&source).frames, 3);
	assert_int_equal(source_counts(&source).lost, 2);
	assert_true(source_decode(&source, 99));
	assert_false(source_has_news(&source));
	assert_int_equal(fake.out, 0);
	assert_int_equal(source.canvas.width, 16);
	assert_int_equal(source.canvas.pixels[0], 33);
	assert_int_equal(source.picture_ns, 1002); /* the time stamp of the frame itself */
	source_drop(&source);			   /* without a held frame: harmless */
}

TEST_BETWEEN("no frame is no trouble", test_source_begin, test_source_end)
{
	must_open();
	fake.grab_err = -EAGAIN;
	test_source_take(5);
	assert_true(source_is_open(&source));
	assert_false(source_has_news(&source));
	assert_int_equal(source_descriptor(&source), 42);
}

TEST_BETWEEN("a camera on demand is left alone while its frame is held", test_source_begin,
	     test_source_end)
{
	fake.on_demand = true;
	assert_int_equal(source_descriptor(&source), -1);
	must_open();
	assert_int_equal(source_descriptor(&source), 42);
	test_source_take(777);
	assert_int_equal(source_descriptor(&source), -1);
	assert_true(source_decode(&source, 99));
	assert_int_equal(source_descriptor(&source), 42);
	assert_int_equal(source.picture_ns, 777); /* the time when it was made */
	assert_int_equal(source_counts(&source).lost, 0);
}

TEST_BETWEEN("a lost camera leaves its picture", test_source_begin, test_source_end)
{
	must_open();
	test_source_take(1);
	assert_true(source_decode(&source, 99));
	fake.grab_err = -ENODEV;
	fake.situation = CAMERA_NO_DEVICE;
	test_source_take(2);
	assert_false(source_is_open(&source));
	assert_int_equal(source_descriptor(&source), -1);
	assert_int_equal(source.opening.situation, CAMERA_NO_DEVICE);
	assert_int_equal(source.counts.losses, 1);
	assert_true(source_has_picture(&source));
	assert_int_equal(source.canvas.pixels[0], 100);
	fake.grab_err = 0;
	must_open();
	fake.level = 7;
	test_source_take(3);
	assert_true(source_decode(&source, 99));
	assert_int_equal(source.canvas.pixels[0], 7);
	assert_int_equal(source_counts(&source).frames, 2); /* frames of both openings */
}

/* A camera whose driver reports no situation is broken; its error says whether waiting can mend it.
 */
/* A camera that was never there was not lost; nor is one that rests. */
TEST_BETWEEN("losses are counted", test_source_begin, test_source_end)
{
	fake.open_err = -ENODEV;
	fake.situation = CAMERA_NO_DEVICE;
	for (int i = 0; i < 3; i++)
		assert_int_equal(opened(), -ENODEV);
	assert_int_equal(source.counts.losses, 0);
	fake.open_err = 0;
	for (int i = 1; i <= 5; i++) {
		must_open();
		fake.grab_err = 0;
		test_source_take(2 * i);
		assert_true(source_decode(&source, 2 * i));
		fake.grab_err = -ENODEV;
		test_source_take(2 * i + 1);
		assert_int_equal(source.counts.losses, i);
	}
	fake.grab_err = 0;
	must_open();
	test_source_take(20);
	assert_true(source_decode(&source, 20));
	source_rest(&source, true);
	assert_false(source_is_open(&source));
	assert_false(source_has_picture(&source));
	source_open(&source);
	assert_int_equal(source_descriptor(&source), -1);
	source_rest(&source, false);
	must_open();
	test_source_take(21);
	assert_int_equal(source.counts.losses, 5);
	/* Whoever rests while the camera is being opened closes it again. */
	must_close();
	fake.gate = eventfd(0, EFD_CLOEXEC);
	source_open(&source);
	source_rest(&source, true);
	assert_int_equal(eventfd_write(fake.gate, 1), 0);
	assert_int_equal(opened(), 0);
	assert_false(source_is_open(&source));
	assert_int_equal(fake.opened, fake.closed);
	close(fake.gate);
}

TEST_BETWEEN("which failures waiting can mend", test_source_begin, test_source_end)
{
	static const struct {
		int err;
		enum camera_situation situation;
		bool hopeless;
	} cases[] = {{-ENODEV, CAMERA_NO_DEVICE, false},
		     {-EINVAL, CAMERA_NO_DEVICE, false},
		     {-ENOLINK, CAMERA_NO_SIGNAL, false},
		     {-EBUSY, CAMERA_BUSY, false},
		     {-ENOSPC, CAMERA_NO_BANDWIDTH, false},
		     {-EIO, CAMERA_STALLED, false},
		     {-EACCES, CAMERA_NO_PERMISSION, false},
		     {-ENOTSUP, CAMERA_UNSUPPORTED_FORMAT, false},
		     {-EINVAL, CAMERA_UNSUPPORTED_FORMAT, true},
		     {-ENOTTY, CAMERA_BROKEN, true},
		     {-EINVAL, CAMERA_BROKEN, true},
		     {-ENOTSUP, CAMERA_BROKEN, true},
		     {-EOPNOTSUPP, CAMERA_BROKEN, true},
		     {-EBADMSG, CAMERA_FINE, true},
		     {-EIO, CAMERA_BROKEN, false},
		     {-EPROTO, CAMERA_FINE, false},
		     {-EPIPE, CAMERA_BROKEN, false},
		     {-ETIMEDOUT, CAMERA_BROKEN, false},
		     {-EREMOTEIO, CAMERA_BROKEN, false},
		     {-ENOMEM, CAMERA_BROKEN, false}};

	for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
		fake.open_err = cases[i].err;
		fake.situation = cases[i].situation;
		assert_int_equal(opened(), cases[i].err);
		assert_true(source.opening.tried);
		assert_string_equal(told.text, "fake: it is broken");
		if (camera_is_hopeless(source.opening.situation, cases[i].err) != cases[i].hopeless)
			fail_msg("%s, %s", strerror(-cases[i].err),
				 camera_situation_names[cases[i].situation]);
	}
}

TEST_BETWEEN("silence is named and ended", test_source_begin, test_source_end)
{
	int64_t start;

	must_open();
	start = source.heard_ns;
	source_watch(&source, start + NS_PER_S);
	assert_int_equal(source.opening.situation, CAMERA_FINE);
	source_watch(&source, start + 3 * NS_PER_S);
	assert_int_equal(source.opening.situation, CAMERA_STALLED);
	assert_true(source_is_open(&source));
	test_source_take(start + 4 * NS_PER_S); /* the camera is back */
	assert_int_equal(source.opening.situation, CAMERA_FINE);
	/* The program holds its frame, so it is not silent. */
	source_watch(&source, start + 9 * NS_PER_S);
	assert_true(source_is_open(&source));
	assert_true(source_decode(&source, 99));
	source_watch(&source, start + 11 * NS_PER_S);
	assert_false(source_is_open(&source));
	assert_int_equal(source.opening.situation, CAMERA_STALLED);
}

/* Opening again would begin the wait anew; after a first picture it brings a start's key frame. */
TEST_BETWEEN("a key frame is waited for", test_source_begin, test_source_end)
{
	int64_t start;

	must_open();
	start = source.heard_ns;
	fake.grab_err = -EAGAIN;
	for (int s = 1; s < 60; s++) {
		source.camera.keyless_ns = start + s * NS_PER_S;
		source_watch(&source, start + s * NS_PER_S);
		assert_true(source_is_open(&source));
		assert_int_equal(source.opening.situation, s < 2 ? CAMERA_FINE : CAMERA_STALLED);
	}
	assert_non_null(strstr(source.opening.why.text, "key frame"));
	source_watch(&source, start + 60 * NS_PER_S);
	assert_false(source_is_open(&source));
	must_open();
	start = source.heard_ns;
	source.camera.keyless_ns = start + NS_PER_S; /* and then none any more */
	source_watch(&source, start + 6 * NS_PER_S);
	assert_false(source_is_open(&source));
	must_open();
	start = source.heard_ns;
	source.camera.frames = 1;
	source.camera.keyless_ns = start + 6 * NS_PER_S;
	source_watch(&source, start + 6 * NS_PER_S);
	assert_false(source_is_open(&source));
}

/* An exposure of some seconds at night is not silence. */
TEST_BETWEEN("a slow camera is waited for", test_source_begin, test_source_end)
{
	fake.rate_hz = 0.2;
	must_open();
	test_source_take(NS_PER_S);
	assert_true(source_decode(&source, NS_PER_S));
	source_watch(&source, 15 * NS_PER_S);
	assert_int_equal(source.opening.situation, CAMERA_FINE);
	source_watch(&source, 16 * NS_PER_S);
	assert_int_equal(source.opening.situation, CAMERA_STALLED);
	source_watch(&source, 45 * NS_PER_S);
	assert_true(source_is_open(&source));
	source_watch(&source, 46 * NS_PER_S);
	assert_false(source_is_open(&source));

	fake.rate_hz = 1e-300;
	must_open();
	test_source_take(100 * NS_PER_S);
	assert_true(source_decode(&source, 100 * NS_PER_S));
	source_watch(&source, 160 * NS_PER_S);
	assert_int_equal(source.opening.situation, CAMERA_STALLED);
}

TEST_BETWEEN("a frame that does not decode is passed over", test_source_begin, test_source_end)
{
	must_open();
	test_source_take(1);
	assert_true(source_decode(&source, 99));
	fake.bytes = 10;
	fake.level = 5;
	test_source_take(2);
	assert_false(source_decode(&source, 99));
	assert_int_equal(fake.out, 0);
	assert_int_equal(source.canvas.pixels[0], 100);
	assert_int_equal(source.picture_ns, 1000);
	assert_int_equal(source_counts(&source).broken, 1);
}

/* The camera sends a JPEG of this size from now on; level: of its grey. */
static void send_jpeg(int width, int height, int level)
{
	static uint8_t grey[64 * 64];
	tjhandle handle = tjInitCompress();
	unsigned char *out = fake.jpeg;

	for (int i = 0; i < width * height; i++)
		grey[i] = (uint8_t)(level + i * 5 % 3);
	fake.format = PIXEL_MJPEG;
	fake.jpeg_bytes = sizeof(fake.jpeg);
	assert_int_equal(tjCompress2(handle, grey, width, 0, height, TJPF_GRAY, &out,
				     &fake.jpeg_bytes, TJSAMP_GRAY, 95, TJFLAG_NOREALLOC),
			 0);
	tjDestroy(handle);
}

/* The same, cut at three quarters, with an end marker: decoders make the rest grey. */
static void send_damaged_jpeg(int level)
{
	send_jpeg(16, 8, level);
	fake.jpeg_bytes -= 24;
	fake.jpeg[fake.jpeg_bytes - 2] = 0xff;
	fake.jpeg[fake.jpeg_bytes - 1] = 0xd9;
}

static bool take_and_decode(int64_t now_ns)
{
	test_source_take(now_ns);
	return source_decode(&source, now_ns);
}

TEST_BETWEEN("a damaged jpeg is never shown", test_source_begin, test_source_end)
{
	send_jpeg(16, 8, 100);
	must_open();
	assert_true(take_and_decode(1));
	for (int i = 0; i < 4; i++) {
		send_damaged_jpeg(200);
		assert_false(take_and_decode(2));
		for (int y = 0; y < 8; y++)
			assert_in_range(source.canvas.pixels[(size_t)y * source.canvas.stride], 98,
					104);
		send_jpeg(16, 8, 100);
		assert_true(take_and_decode(3));
	}
	assert_int_equal(source.opening.situation, CAMERA_FINE);
	assert_int_equal(source_counts(&source).broken, 4);
}

TEST_BETWEEN("only damaged pictures are a situation", test_source_begin, test_source_end)
{
	send_damaged_jpeg(100);
	must_open();
	assert_false(take_and_decode(NS_PER_S));
	assert_false(take_and_decode(2 * NS_PER_S));
	assert_int_equal(source.opening.situation, CAMERA_FINE);
	assert_false(take_and_decode(4 * NS_PER_S));
	assert_int_equal(source.opening.situation, CAMERA_DAMAGED);
	assert_false(source_has_picture(&source));
	test_source_take(5 * NS_PER_S); /* a frame that comes does not show that it decodes */
	assert_int_equal(source.opening.situation, CAMERA_DAMAGED);
	send_jpeg(16, 8, 100);
	assert_true(take_and_decode(6 * NS_PER_S));
	assert_int_equal(source.opening.situation, CAMERA_FINE);
	fake.grab_err = -ENODEV;
	fake.situation = CAMERA_NO_DEVICE;
	test_source_take(7 * NS_PER_S);
	assert_int_equal(source.opening.situation, CAMERA_NO_DEVICE);
}

TEST_BETWEEN("a jpeg of another size is shown when it comes again", test_source_begin,
	     test_source_end)
{
	must_open();
	send_jpeg(16, 8, 100);
	assert_true(take_and_decode(1));
	send_jpeg(24, 16, 50); /* padding to whole blocks */
	assert_true(take_and_decode(2));
	assert_int_equal(source.canvas.width, 16);
	assert_int_equal(source.canvas.height, 8);
	assert_in_range(source.canvas.pixels[0], 48, 54);
	send_jpeg(40, 30, 150); /* once it may be damage to the header */
	assert_false(take_and_decode(3));
	assert_int_equal(source.canvas.width, 16);
	send_jpeg(40, 30, 150);
	assert_true(take_and_decode(4));
	assert_int_equal(source.canvas.width, 40);
	assert_int_equal(source.canvas.height, 30);
	assert_in_range(source.canvas.pixels[29 * source.canvas.stride + 4 * 39], 148, 154);
	send_jpeg(16, 8, 100);
	assert_true(take_and_decode(5));
	assert_int_equal(source.canvas.width, 16);
}

static const struct view all = {.width = 16, .height = 8, .squash = 1};

/* With spare buffers, a raw frame is read where the camera left it. */
static void show_raw(int level)
{
	source.settings.camera.buffers = 4;
	fake.level = (uint8_t)level;
	test_source_take(level);
	assert_true(source_decode(&source, 99));
	assert_false(source_has_news(&source));
	assert_true(source_has_picture(&source));
	assert_int_equal(fake.out, 1);
	assert_false(source.whole);
}

TEST_BETWEEN("a raw frame stays until the next", test_source_begin, test_source_end)
{
	struct eye eye = {.section = "background", .source = &source, .wanted = all};
	struct frame_reader reader;
	uint32_t pixel;

	must_open();
	show_raw(33);
	assert_int_equal(eye_fit(&eye, NULL), 0);
	assert_true(eye_read(&eye, &reader));
	frame_reader_make(&reader, 15, 7, 1, 1, (uint8_t *)&pixel, 4);
	assert_int_equal(pixel, 0xff212121);
	/* A caller that wants the whole picture. */
	assert_int_equal(eye_picture(&eye).origin[0], 33);
	assert_false(eye_read(&eye, &reader));
	show_raw(34); /* raw again: nobody wants it whole */
	fake.level = 35;
	test_source_take(7);
	assert_int_equal(fake.out, 1);
	assert_true(source_has_news(&source));
	assert_false(source_has_picture(&source));
	assert_true(source_decode(&source, 99));
	assert_int_equal(eye_picture(&eye).origin[0], 35);
	source_drop(&source);
	assert_int_equal(fake.out, 0);
	assert_true(source_has_picture(&source));
	assert_int_equal(source_counts(&source).lost, 0);
}

TEST_BETWEEN("a lost camera leaves its raw frame", test_source_begin, test_source_end)
{
	must_open();
	show_raw(60);
	fake.grab_err = -EAGAIN; /* a wake-up without a frame */
	test_source_take(2);
	assert_int_equal(fake.out, 0);
	assert_true(source_has_picture(&source));
	assert_int_equal(source.canvas.pixels[0], 60);
	fake.grab_err = 0;
	show_raw(61);
	test_source_take(3); /* a frame whose picture nobody has taken yet */
	fake.grab_err = -ENODEV;
	test_source_take(4);
	assert_false(source_is_open(&source));
	assert_true(source_has_picture(&source));
	assert_int_equal(source.canvas.pixels[0], 61);
	fake.grab_err = 0;
	must_open();
	show_raw(62);
	source_watch(&source, clock_now_ns() + 60 * NS_PER_S); /* silent for good */
	assert_false(source_is_open(&source));
	assert_int_equal(source.canvas.pixels[0], 62);
	assert_true(source_has_picture(&source));
}

TEST_BETWEEN("a raw frame that is short is passed over", test_source_begin, test_source_end)
{
	must_open();
	show_raw(70);
	fake.bytes = 10;
	fake.level = 5;
	test_source_take(2);
	assert_true(source_has_picture(&source));
	assert_false(source_decode(&source, 99));
	assert_int_equal(fake.out, 0);
	assert_int_equal(source.canvas.pixels[0], 70);
	assert_int_equal(source_counts(&source).broken, 1);
}

/* The picture of a frozen camera, and of a camera that others wait for. */
TEST_BETWEEN("a kept picture outlives its frame", test_source_begin, test_source_end)
{
	must_open();
	for (int way = 0; way < 2; way++) {
		show_raw(80 + way);
		source.kept = way == 0;
		source.camera.on_demand = way == 1;
		fake.level = 5;
		test_source_take(2);
		assert_true(source_has_news(&source));
		assert_true(source_has_picture(&source));
		assert_int_equal(source.canvas.pixels[0], 80 + way);
		source.camera.on_demand = false;
		source.kept = false;
		source_drop(&source);
		assert_true(source_has_picture(&source));
	}
}

/* By IEC 61966-2-1: 0.214041 is code 127.5. */
TEST_BETWEEN("linear light is kept and encoded", test_source_begin, test_source_end)
{
	const uint8_t *p = NULL;

	fake.format = PIXEL_RGBF;
	fake.linear[0] = 3.5f;
	fake.linear[1] = 0.2158605f; /* code 128 */
	fake.linear[2] = NAN;
	must_open();
	test_source_take(1);
	assert_true(source_decode(&source, 99));
	assert_true(source.is_linear);
	assert_true(source.linear.f32[0] == 3.5f);
	p = source.canvas.pixels + 4;
	assert_int_equal(p[2], 255);
	assert_int_equal(p[1], 128);
	assert_int_equal(p[0], 0);
	assert_int_equal(p[3], 255);
	fake.bytes = 100;
	test_source_take(2);
	assert_false(source_decode(&source, 99));
}

/* Depths stay in the camera's memory, turned or not, and there are none of a camera that is
 * lost. */
TEST_BETWEEN("depths are read in place", test_source_begin, test_source_end)
{
	for (int turn = 0; turn < PICTURE_TURN_COUNT; turn++) {
		struct eye eye = {.section = "depth", .source = &source, .wanted = {.squash = 1}};
		struct frame_reader reader;
		struct depth_map map;

		test_source_end(state);
		test_source_begin(state);
		source_destroy(&source);
		assert_int_equal(
			source_create(&source,
				      &(struct source_settings){.name = "depth",
								.ops = &fake_ops,
								.camera = {.buffers = 4},
								.turn = turn,
								.curve = {.named = TRANSFER_SRGB}}),
			0);
		fake.format = PIXEL_Z16;
		fake.level = 1;
		assert_false(eye_depth(&eye, 0.001, &map));
		must_open();
		test_source_take(1);
		assert_true(source_decode(&source, 99));
		assert_int_equal(eye_fit(&eye, NULL), 0);
		assert_true(eye_depth(&eye, 0.001, &map));
		assert_int_equal(map.width, picture_turn_is_sideways(turn) ? 8 : 16);
		assert_true(depth_map_at(&map, map.width - 1, map.height - 1) == 257 * 0.001);
		assert_int_equal(eye_read(&eye, &reader), turn == PICTURE_UPRIGHT);
		assert_int_equal(eye_picture(&eye).width, map.width); /* for eyes */
		must_close();
		assert_false(eye_depth(&eye, 0.001, &map));
	}
}

TEST_BETWEEN("a depth camera sets no pace", test_source_begin, test_source_end)
{
	const struct eyes eyes = {.depth = {.section = "depth", .source = &source}};

	must_open();
	assert_null(eyes_leader(&eyes));
}

TEST_BETWEEN("the picture follows the cameras size", test_source_begin, test_source_end)
{
	struct eye eye = {.section = "fisheye", .source = &source, .wanted = {.squash = 1}};
	struct fault fault = {.text = ""};

	assert_int_equal(eye_fit(&eye, &fault), 0); /* no picture yet */
	must_open();
	test_source_take(1);
	assert_true(source_decode(&source, 99));
	assert_int_equal(eye_fit(&eye, &fault), 0);
	assert_int_equal(eye.view.width, 16);
	fake.width = 32;
	fake.height = 24;
	test_source_take(2);
	assert_true(source_decode(&source, 99));
	assert_int_equal(eye_fit(&eye, &fault), 0);
	assert_int_equal(eye.view.width, 32);
	assert_int_equal(eye_picture(&eye).height, 24);
	eye.wanted.x = 20;
	fake.width = 16;
	test_source_take(3);
	assert_true(source_decode(&source, 99));
	assert_int_equal(eye_fit(&eye, &fault), -EINVAL);
	assert_memory_equal(fault.text, "[fisheye] ", 10);
}

/* A device that opens slowly delays nothing except the end of the program. */
TEST_BETWEEN("opening is waited for by nobody but the end", test_source_begin, test_source_end)
{
	struct pollfd end;

	fake.gate = eventfd(0, EFD_CLOEXEC);
	assert_true(fake.gate >= 0);
	source_open(&source);
	source_open(&source); /* a second call changes nothing */
	end = (struct pollfd){.fd = source_descriptor(&source), .events = POLLIN};
	assert_int_equal(poll(&end, 1, 0), 0);
	test_source_take(1); /* nothing yet: harmless */
	assert_false(source_is_open(&source));
	assert_false(source.opening.tried);
	assert_int_equal(source_counts(&source).frames, 0);
	source_watch(&source, 99 * NS_PER_S);
	assert_int_equal(eventfd_write(fake.gate, 1), 0);
	source_destroy(&source); /* waits, and closes the device that was opened */
	assert_int_equal(fake.opened, 1);
	assert_int_equal(fake.closed, 1);
	close(fake.gate);
}

TEST_BETWEEN("another standard is opened at once", test_source_begin, test_source_end)
{
	struct pollfd end;

	must_open();
	test_source_take(1);
	assert_true(source_decode(&source, 99));
	fake.grab_err = -ESTALE;
	fake.situation = CAMERA_NO_SIGNAL;
	test_source_take(2);
	assert_true(source.opening.begun);
	fake.grab_err = 0;
	end = (struct pollfd){.fd = source_descriptor(&source), .events = POLLIN};
	assert_int_equal(poll(&end, 1, 60000), 1);
	test_source_take(3);
	assert_true(source_is_open(&source));
	/* Until a frame shows that the camera works. */
	assert_int_equal(source.opening.situation, CAMERA_NO_SIGNAL);
	test_source_take(4);
	assert_int_equal(source.opening.situation, CAMERA_FINE);
	/* if a camera asks for it before its first frame, the program would only open it again and
	 * again */
	must_close();
	must_open();
	fake.grab_err = -ESTALE;
	test_source_take(5);
	assert_false(source.opening.begun);
	assert_false(source_is_open(&source));
}

TEST_BETWEEN("silence is excused when nobody listened", test_source_begin, test_source_end)
{
	int64_t start;

	must_open();
	start = source.heard_ns;
	source_excuse(&source, start + 10 * NS_PER_S);
	source_watch(&source, start + 11 * NS_PER_S);
	assert_true(source_is_open(&source));
	assert_int_equal(source.opening.situation, CAMERA_FINE);
	source_watch(&source, start + 13 * NS_PER_S);
	assert_int_equal(source.opening.situation, CAMERA_STALLED);
}

TEST_BETWEEN("a camera keeps its name while it is away", test_source_begin, test_source_end)
{
	assert_string_equal(source_device_name(&source), "front");
	fake.name = "C920";
	must_open();
	assert_string_equal(source_device_name(&source), "C920");
	must_close();
	fake.open_err = -ENODEV;
	assert_int_equal(opened(), -ENODEV);
	assert_string_equal(source_device_name(&source), "C920");
}
