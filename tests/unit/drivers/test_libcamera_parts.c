/* SPDX-License-Identifier: MIT */
/* The C parts of the libcamera driver: choice by name, events between threads, pictures in buffers,
 * elements of values, what udev says, messages. */
#include <dlfcn.h>
#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "drivers/libcamera/parts.h"
#include "hal/base/clock.h"
#include "tests/support/captured_log.h"
#include "tests/support/own_folder.h"
#include "tests/support/test.h"

/* ---- names ---- */

TEST("cameras are found by name")
{
	static const struct libcamera_name cameras[] = {
		{"platform/isp imx219 0", "imx219"},
		{"platform/isp imx219 1", "imx219"},
		{"usb-1.2 046d", "Webcam of imx708"},
		{"platform/isp imx708", "imx708"},
		{"imx708", "another"},
	};
	static const struct {
		const char *wanted;
		int expected;
	} cases[] = {
		{"", 0},
		{"platform/isp imx219 1", 1},
		{"IMX219 1", 1},
		{"imx708", 4}, /* an id goes before a model */
		{"Webcam of imx708", 2},
		{"another", 4},
		{"046D", 2},
		{"imx219", -EINVAL},
		{"platform", -EINVAL},
		{"ov5647", -ENODEV},
	};
	struct fault fault;

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++)
		assert_int_equal(libcamera_find(cameras, 5, cases[i].wanted, &fault),
				 cases[i].expected);
	assert_string_equal(
		fault.text,
		"no camera \"ov5647\"; there is platform/isp imx219 0 (imx219), "
		"platform/isp imx219 1 (imx219), usb-1.2 046d (Webcam of imx708), platform/isp imx708 (imx708), imx708 (another)");
	libcamera_find(cameras, 5, "imx219", &fault);
	assert_string_equal(
		fault.text,
		"\"imx219\" fits more than one camera, expected one of platform/isp imx219 0 (imx219), platform/isp imx219 1 (imx219)");
}

TEST("names that do not fit are cut")
{
	struct libcamera_name cameras[40];
	struct fault fault;

	for (int i = 0; i < 40; i++)
		cameras[i] = (struct libcamera_name){"platform/a path as long as such paths are",
						     "a model"};
	assert_int_equal(libcamera_find(cameras, 40, "other", &fault), -ENODEV);
	assert_int_equal(strlen(fault.text), sizeof(fault.text) - 1);
}

/* ---- values ---- */

TEST("elements are packed as they were unpacked")
{
	static const struct {
		enum libcamera_kind kind;
		int64_t memory[2];
		size_t size;
		int count;
		double expected[2];
	} cases[] = {
		{LIBCAMERA_BOOL, {1}, 1, 1, {1}},
		{LIBCAMERA_BYTE, {0x80ff}, 2, 2, {255, 128}},
		{LIBCAMERA_INT32, {INT64_C(-4294967289)}, 8, 2, {7, -1}},
		{LIBCAMERA_INT64, {-5, INT64_C(1) << 40}, 16, 2, {-5, 0x1p40}},
		{LIBCAMERA_FLOAT, {INT64_C(0xc000000040200000)}, 8, 2, {2.5, -2}},
		{LIBCAMERA_OTHER, {42}, 0, 0, {0}},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct libcamera_value value;
		int64_t memory[2] = {0, 0};

		libcamera_value_unpack(&value, cases[i].kind, cases[i].count, cases[i].memory);
		assert_int_equal(value.count, cases[i].count);
		for (int n = 0; n < value.count; n++)
			assert_true(value.numbers[n] == cases[i].expected[n]);
		libcamera_value_pack(&value, memory);
		assert_memory_equal(memory, cases[i].memory, cases[i].size);
	}
}

TEST("long arrays are cut")
{
	float elements[LIBCAMERA_NUMBERS_MAX + 4];
	struct libcamera_value value;
	char text[LIBCAMERA_VALUE_TEXT_MAX];

	for (int i = 0; i < LIBCAMERA_NUMBERS_MAX + 4; i++)
		elements[i] = -1.23456789e-30f;
	libcamera_value_unpack(&value, LIBCAMERA_FLOAT, LIBCAMERA_NUMBERS_MAX + 4, elements);
	assert_int_equal(value.count, LIBCAMERA_NUMBERS_MAX);
	libcamera_value_text(&value, text);
	assert_int_equal(strncmp(text, "-1.23456", 8), 0);
	assert_true(strlen(text) < LIBCAMERA_VALUE_TEXT_MAX);
}

/* ---- events ---- */

static bool readable(const struct libcamera_events *events)
{
	struct pollfd one = {.fd = events->descriptor, .events = POLLIN};

	return poll(&one, 1, 0) == 1;
}

static void *all_done(void *events)
{
	for (int i = LIBCAMERA_REQUESTS_MAX - 1; i >= 0; i--)
		libcamera_events_done(events, i);
	return NULL;
}

TEST("requests are taken in the order in which they were done")
{
	struct libcamera_events events;
	pthread_t thread;

	assert_int_equal(libcamera_events_open(&events, NULL), 0);
	assert_false(readable(&events));
	assert_int_equal(libcamera_events_take(&events), -EAGAIN);
	assert_int_equal(pthread_create(&thread, NULL, all_done, &events), 0);
	pthread_join(thread, NULL);
	for (int i = LIBCAMERA_REQUESTS_MAX - 1; i >= 0; i--) {
		assert_true(readable(&events));
		assert_int_equal(libcamera_events_take(&events), i);
	}
	assert_false(readable(&events));
	assert_int_equal(libcamera_events_take(&events), -EAGAIN);
	libcamera_events_close(&events);
	libcamera_events_close(&events);
}

TEST("the end stays")
{
	struct libcamera_events events;

	assert_int_equal(libcamera_events_open(&events, NULL), 0);
	libcamera_events_done(&events, 3);
	libcamera_events_end(&events);
	libcamera_events_done(&events, 4);
	assert_int_equal(libcamera_events_take(&events), 3);
	for (int i = 0; i < 3; i++)
		assert_int_equal(libcamera_events_take(&events), -ENODEV);
	assert_true(libcamera_events_end_soon(&events));
	libcamera_events_close(&events);
}

static void *end_later(void *events)
{
	const struct timespec later = {0, 20 * NS_PER_MS};

	libcamera_events_done(events, 1);
	nanosleep(&later, NULL);
	libcamera_events_end(events);
	return NULL;
}

TEST("the end is waited for a moment")
{
	struct libcamera_events events;
	bool ended = false;
	pthread_t thread;
	int64_t start_ns;
	int moments = 0;

	assert_int_equal(libcamera_events_open(&events, NULL), 0);
	start_ns = clock_now_ns();
	libcamera_events_done(&events, 2);
	assert_false(libcamera_events_end_soon(&events));
	assert_true(clock_now_ns() - start_ns >= 300 * NS_PER_MS);
	assert_int_equal(pthread_create(&thread, NULL, end_later, &events), 0);
	/* on a busy machine the thread may need more than a moment */
	while (!ended && moments++ < 200)
		ended = libcamera_events_end_soon(&events);
	assert_true(ended);
	pthread_join(thread, NULL);
	libcamera_events_close(&events);
}

static bool none(const void *context, dev_t number)
{
	(void)context;
	(void)number;
	return false;
}

int __real_inotify_add_watch(int fd, const char *path, uint32_t mask);
int __wrap_inotify_add_watch(int fd, const char *path, uint32_t mask);

/* The test's own folder is watched in place of /dev. */
int __wrap_inotify_add_watch(int fd, const char *path, uint32_t mask)
{
	assert_string_equal(path, "/dev/");
	return __real_inotify_add_watch(fd, own_folder(), mask);
}

/* The kernel reports names; a file stands for a node. */
TEST("a node that goes is noticed")
{
	struct libcamera_events events;
	FILE *file;

	assert_int_equal(libcamera_events_open(&events, NULL), 0);
	assert_int_equal(libcamera_events_watch(&events, none, NULL, NULL), 0);
	events.nodes[253] = true;
	/* Another node; its own, which then is gone for good; another. */
	for (int i = 0; i < 3; i++) {
		const char *const name = own_folder_path(i == 1 ? "video253" : "video254");

		file = fopen(name, "w");
		assert_non_null(file);
		fclose(file);
		assert_false(readable(&events));
		assert_int_equal(remove(name), 0);
		assert_true(readable(&events));
		assert_int_equal(libcamera_events_deleted(&events), i > 0);
	}
	assert_int_equal(libcamera_events_take(&events), -EAGAIN);
	libcamera_events_close(&events);
}

/* ---- pictures ---- */

enum { WIDTH = 16, HEIGHT = 6, STRIDE = 32, LUMA = STRIDE * HEIGHT, CHROMA = LUMA / 2 };

static int memory_of(size_t bytes)
{
	const int fd = memfd_create("picture", MFD_CLOEXEC);

	assert_true(fd >= 0);
	assert_int_equal(ftruncate(fd, (off_t)bytes), 0);
	return fd;
}

static struct libcamera_picture picture_of(enum pixel_format format)
{
	return (struct libcamera_picture){.format = format, .width = WIDTH, .height = HEIGHT};
}

static int map_into(size_t bytes, size_t stride, struct libcamera_picture *picture,
		    struct libcamera_span *spans, int count)
{
	static int memory = -1; /* open until the next call */

	if (memory >= 0)
		close(memory);
	memory = memory_of(bytes);
	for (int i = 0; i < count; i++)
		spans[i].fd = memory;
	return libcamera_picture_map(picture, stride, spans, count);
}

TEST("planes lie where they are said to")
{
	struct libcamera_span apart[2] = {{-1, 64, LUMA}, {-1, 64 + LUMA, CHROMA}};
	struct libcamera_span together[1] = {{-1, 0, LUMA + CHROMA}};
	struct libcamera_picture p;

	p = picture_of(PIXEL_NV12);
	assert_int_equal(map_into(64 + LUMA + CHROMA, STRIDE, &p, apart, 2), 0);
	assert_int_equal(p.mapping_count, 1); /* two planes share a descriptor */
	assert_ptr_equal(p.planes[0].data, (uint8_t *)p.mappings[0].memory + 64);
	assert_ptr_equal(p.planes[1].data, p.planes[0].data + LUMA);
	assert_int_equal(p.planes[1].stride, STRIDE);
	assert_int_equal(p.planes[1].bytes, CHROMA);
	libcamera_picture_reading(&p, true); /* not a DMABUF: no error */
	libcamera_picture_reading(&p, false);
	libcamera_picture_unmap(&p);
	libcamera_picture_unmap(&p);

	p = picture_of(PIXEL_NV12);
	assert_int_equal(map_into(LUMA + CHROMA, STRIDE, &p, together, 1), 0);
	assert_ptr_equal(p.planes[1].data, p.planes[0].data + LUMA);
	assert_int_equal(p.planes[1].bytes, CHROMA);
	libcamera_picture_unmap(&p);
}

TEST("memory that is too small is refused")
{
	static const struct {
		enum pixel_format format;
		size_t memory, stride, offset, bytes;
		int err;
	} cases[] = {
		{PIXEL_GREY, LUMA, STRIDE, 0, LUMA, 0},
		{PIXEL_GREY, LUMA, STRIDE, 0, LUMA - STRIDE + WIDTH, 0}, /* no padding at the end */
		{PIXEL_GREY, LUMA, STRIDE, 0, LUMA - STRIDE + WIDTH - 1, -EINVAL},
		{PIXEL_GREY, LUMA - STRIDE, STRIDE, 0, LUMA,
		 -EINVAL}, /* claims more bytes than it has */
		{PIXEL_GREY, LUMA, STRIDE, LUMA, LUMA, -EINVAL},
		{PIXEL_GREY, LUMA, WIDTH - 1, 0, LUMA, -EINVAL},
		{PIXEL_NV12, LUMA, STRIDE, 0, LUMA, -EINVAL},
		{PIXEL_NV12, LUMA, STRIDE, 0, LUMA - STRIDE + WIDTH, -EINVAL},
		{PIXEL_MJPEG, 100, 0, 0, 100, 0},
		{PIXEL_MJPEG, 0, 0, 0, 0, -EINVAL},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct libcamera_picture p = picture_of(cases[i].format);
		struct libcamera_span span = {-1, cases[i].offset, cases[i].bytes};

		assert_int_equal(map_into(cases[i].memory, cases[i].stride, &p, &span, 1),
				 cases[i].err);
		libcamera_picture_unmap(&p);
	}
}

TEST("a part of a picture is none")
{
	struct libcamera_span span = {-1, 0, LUMA};
	struct libcamera_picture p = picture_of(PIXEL_GREY);
	struct frame_plane planes[FRAME_PLANES];
	size_t used = LUMA - STRIDE + WIDTH;

	assert_int_equal(map_into(LUMA, STRIDE, &p, &span, 1), 0);
	assert_true(libcamera_picture_planes(&p, &used, 1, planes));
	assert_int_equal(planes[0].bytes, LUMA);
	used--;
	assert_false(libcamera_picture_planes(&p, &used, 1, planes));
	libcamera_picture_unmap(&p);

	p = picture_of(PIXEL_MJPEG);
	used = 77;
	assert_int_equal(map_into(LUMA, 0, &p, &span, 1), 0);
	assert_true(libcamera_picture_planes(&p, &used, 1, planes));
	assert_int_equal(planes[0].bytes, 77);
	used = 0;
	assert_false(libcamera_picture_planes(&p, &used, 1, planes));
	libcamera_picture_unmap(&p);
}

TEST("times are monotonic")
{
	const int64_t now_ns = clock_now_ns();
	struct timespec boot;

	assert_true(libcamera_picture_time_ns(now_ns - 5 * NS_PER_MS) == now_ns - 5 * NS_PER_MS);
	assert_in_range(libcamera_picture_time_ns(0), now_ns, clock_now_ns() + NS_PER_S);
	assert_in_range(libcamera_picture_time_ns(now_ns + 1000 * NS_PER_S), now_ns,
			clock_now_ns() + NS_PER_S);
	clock_gettime(CLOCK_BOOTTIME, &boot);
	assert_true(libcamera_picture_time_ns((int64_t)boot.tv_sec * NS_PER_S + boot.tv_nsec) <=
		    clock_now_ns());
}

/* ---- messages ---- */

TEST("messages lose their head and are said once")
{
	static const char *const lines[] = {
		"[0:01:02.000000000] [42] ERROR V4L2 v4l2.cpp:1 /dev/video0: Failed\n",
		"[0:01:03.000000000] [42] ERROR V4L2 v4l2.cpp:1 /dev/video0: Failed\n",
		"[0:01:03.000000000] [42]  INFO Camera camera_manager.cpp:299 libcamera v0.0.3\n",
		"[0:01:03.000000000] [42] \n",
		"\n",
		"FATAL without a head",
	};
	const struct captured_log log = captured_log_begin();
	FILE *stream;
	char said[1024];
	size_t length;

	for (size_t i = 0; i < sizeof(lines) / sizeof(lines[0]); i++)
		libcamera_message(lines[i], strlen(lines[i]));
	stream = captured_log_end(&log);
	length = fread(said, 1, sizeof(said) - 1, stream);
	said[length] = '\0';
	fclose(stream);
	assert_string_equal(said, "inlay: libcamera: ERROR V4L2 v4l2.cpp:1 /dev/video0: Failed\n"
				  "inlay: libcamera: FATAL without a head\n");
}

/* ---- what udev says (libudev is played: dlsym() finds these functions) ---- */

struct udev_device {
	const char *action, *node;
};

const char *udev_device_get_action(struct udev_device *device);
const char *udev_device_get_devnode(struct udev_device *device);
void *__wrap_dlsym(void *handle, const char *name);

static const char *played_action(struct udev_device *device)
{
	return device->action;
}

static const char *played_node(struct udev_device *device)
{
	return device->node;
}

void *__wrap_dlsym(void *handle, const char *name)
{
	const char *(*const found)(struct udev_device *) = strcmp(name, "udev_device_get_action")
								   ? played_node
								   : played_action;

	assert_ptr_equal(handle, RTLD_NEXT);
	return *(void *const *)&found;
}

TEST("a remove that is late is none")
{
	struct udev_device back = {"remove", "/dev/null"};
	struct udev_device gone = {"remove", "/dev/there-is-no-such-node"};
	const unsigned kept = libcamera_hotplug_kept();

	assert_string_equal(udev_device_get_action(&back), "change");
	assert_string_equal(udev_device_get_devnode(&back), "/dev/null");
	assert_string_equal(udev_device_get_action(&gone), "remove");
	assert_string_equal(udev_device_get_devnode(&gone), gone.node);
	assert_int_equal(libcamera_hotplug_kept(), kept);
}

TEST("what is new is kept")
{
	struct udev_device fresh = {"add", "/dev/null"};
	struct udev_device other = {"bind", "/dev/null"};
	const unsigned kept = libcamera_hotplug_kept();

	assert_string_equal(udev_device_get_action(&other), "bind");
	assert_int_equal(libcamera_hotplug_kept(), kept);
	assert_string_equal(udev_device_get_action(&fresh), "change");
	assert_int_equal(libcamera_hotplug_kept(), kept + 1);
}

/* udev returns NULL when it has said more than the socket holds. */
TEST("no device is no string of null")
{
	struct udev_device nameless = {NULL, NULL};
	const unsigned kept = libcamera_hotplug_kept();

	assert_string_equal(udev_device_get_action(&nameless), "");
	assert_string_equal(udev_device_get_devnode(&nameless), "");
	assert_int_equal(libcamera_hotplug_kept(), kept);
	assert_string_equal(udev_device_get_action(NULL), "change");
	assert_string_equal(udev_device_get_devnode(NULL), "");
	assert_int_equal(libcamera_hotplug_kept(), kept + 1);
}

TEST_GROUP(own_folder_make, own_folder_remove);
