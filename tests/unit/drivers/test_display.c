/* SPDX-License-Identifier: MIT */
/* Screens: the wrappers' rules on a screen that records calls, the clock of the null screen, the
 * files of the file screen, the window on SDL's dummy desktop, and the choice of a KMS mode. */
#include <errno.h>
#include <glob.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "drivers/drivers.h"
#include "hal/base/clock.h"
#include "hal/image/image.h"
#include "tests/support/expect.h"
#include "tests/support/own_folder.h"

#if WITH_SDL
#include <SDL.h>
#endif
#if WITH_KMS
#include "drivers/kms/kms.h"
#include "tests/support/test.h"
#endif

/* ---- the wrappers ---- */

struct display_record {
	int open_result, acquire_result, close_result;
	int closed, submitted;
	enum display_event_kind next;
};

static int record_open(struct display *display, struct fault *fault)
{
	struct display_record *record = display->options;

	display->state = record;
	display->width = display->height = 4;
	return record->open_result ? fault_say(fault, record->open_result, "no") : 0;
}

static int record_descriptor(struct display *display)
{
	(void)display;
	return 7;
}

static int record_acquire(struct display *display, struct display_buffer *buffer)
{
	static uint8_t pixels[64];

	*buffer = (struct display_buffer){pixels, 16, 4, 4, 3};
	return ((struct display_record *)display->state)->acquire_result;
}

static int record_submit(struct display *display, struct display_buffer *buffer, int64_t token,
			 struct fault *fault)
{
	(void)fault;
	assert_int_equal(buffer->index, 3);
	assert_int_equal(token, 42);
	((struct display_record *)display->state)->submitted++;
	return 0;
}

static int record_dispatch(struct display *display, struct display_event *event,
			   struct fault *fault)
{
	struct display_record *record = display->state;

	(void)fault;
	event->kind = record->next;
	record->next = DISPLAY_NOTHING;
	return 0;
}

static int record_close(struct display *display, struct fault *fault)
{
	struct display_record *record = display->state;

	record->closed++;
	return record->close_result ? fault_say(fault, record->close_result, "torn") : 0;
}

static const struct display_ops recorder = {
	.name = "recorder",
	.options_size = sizeof(struct display_record),
	.open = record_open,
	.descriptor = record_descriptor,
	.acquire = record_acquire,
	.submit = record_submit,
	.dispatch = record_dispatch,
	.close = record_close,
};

static uint8_t turned_pixels[6 * 8 * 4];

static int turned_open(struct display *display, struct fault *fault)
{
	(void)fault;
	display->state = display;
	display->width = 8;
	display->height = 6;
	return 0;
}

static int turned_acquire(struct display *display, struct display_buffer *buffer)
{
	(void)display;
	*buffer = (struct display_buffer){turned_pixels, 32, 8, 6, 3};
	return 0;
}

static int turned_submit(struct display *display, struct display_buffer *buffer, int64_t token,
			 struct fault *fault)
{
	(void)display;
	(void)token;
	(void)fault;
	assert_ptr_equal(buffer->pixels, turned_pixels);
	assert_int_equal(buffer->width, 8);
	return 0;
}

static int turned_close(struct display *display, struct fault *fault)
{
	(void)display;
	(void)fault;
	return 0;
}

static const struct display_ops turned = {
	.name = "turned",
	.open = turned_open,
	.acquire = turned_acquire,
	.submit = turned_submit,
	.close = turned_close,
};

/* The first pixel of each corner of the upright picture, clockwise from the upper left, is 1 to 4.
 * Turned by a quarter clockwise, what was at the upper left stands at the upper right. */
TEST("pictures are turned within margins")
{
	struct display_settings settings = {.margins = {1, 1, 2, 1}};

	for (int turn = 0; turn < PICTURE_TURN_COUNT; turn++) {
		const int width = turn % 2 ? 4 : 5, height = turn % 2 ? 5 : 4;
		struct display_buffer b;
		struct display display;
		uint8_t corners[4];

		settings.turn = turn;
		memset(turned_pixels, 77, sizeof(turned_pixels));
		assert_int_equal(display_open(&display, &turned, &settings, NULL, NULL), 0);
		assert_int_equal(display_fit(&display, 8, 6, 1), -ENOTSUP);
		assert_int_equal(display_acquire(&display, &b), 0);
		assert_int_equal(b.width, width);
		assert_int_equal(b.height, height);
		for (int y = 0; y < height; y++)
			memset(b.pixels + (size_t)y * b.stride, 9, (size_t)width * 4);
		memset(b.pixels, 1, 4);
		memset(b.pixels + (size_t)(width - 1) * 4, 2, 4);
		memset(b.pixels + (size_t)(height - 1) * b.stride + (size_t)(width - 1) * 4, 3, 4);
		memset(b.pixels + (size_t)(height - 1) * b.stride, 4, 4);
		assert_int_equal(display_submit(&display, &b, 42, NULL), 0);
		for (int y = 0; y < 6; y++)
			for (int x = 0; x < 8; x++) {
				const bool outside = x < 1 || x >= 6 || y < 1 || y >= 5;

				expect_equal(turned_pixels[32 * y + 4 * x] == 0, outside,
					     "turn %d, (%d, %d)", turn, x, y);
			}
		corners[0] = turned_pixels[32 + 4 * 1];
		corners[1] = turned_pixels[32 + 4 * 5];
		corners[2] = turned_pixels[4 * 32 + 4 * 5];
		corners[3] = turned_pixels[4 * 32 + 4 * 1];
		for (int i = 0; i < 4; i++)
			expect_equal(corners[(i + turn) % 4], i + 1, "turn %d, corner %d", turn, i);
		assert_int_equal(display_close(&display, NULL), 0);
	}
	settings.margins[0] = 7;
	{
		struct display display;
		struct fault fault = {""};

		assert_int_equal(display_open(&display, &turned, &settings, NULL, &fault), -EINVAL);
		assert_non_null(strstr(fault.text, "leave nothing of a screen of 8x6"));
	}
}

TEST("wrappers refuse")
{
	const struct display_settings settings = {.width = 4};
	struct display_record record = {.open_result = -ENODEV};
	struct display display;
	struct display_buffer buffer;
	struct display_event event;
	struct fault fault;

	assert_int_equal(display_open(&display, NULL, &settings, &record, &fault), -EINVAL);
	assert_int_equal(display_open(&display, &recorder, NULL, &record, &fault), -EINVAL);
	assert_int_equal(display_open(&display, &recorder, &settings, NULL, &fault), -EINVAL);
	/* a failed open is closed once, and leaves nothing to misuse */
	assert_int_equal(display_open(&display, &recorder, &settings, &record, &fault), -ENODEV);
	assert_int_equal(record.closed, 1);
	assert_string_equal(fault.text, "no");
	assert_int_equal(display_descriptor(&display), -EBADF);
	assert_int_equal(display_acquire(&display, &buffer), -EBADF);
	assert_int_equal(display_submit(&display, &buffer, 42, &fault), -EBADF);
	assert_int_equal(display_dispatch(&display, &event, &fault), -EBADF);
	assert_int_equal(display_close(&display, &fault), 0);
	assert_int_equal(record.closed, 1);
}

TEST("wrappers lend")
{
	const struct display_settings settings = {.width = 4};
	struct display_record record = {.close_result = -ENOSPC};
	struct display display;
	struct display_buffer buffer, copy;
	struct display_event event;
	struct fault fault;

	assert_int_equal(display_open(&display, &recorder, &settings, &record, &fault), 0);
	assert_int_equal(display_descriptor(&display), 7);
	buffer = (struct display_buffer){(uint8_t *)&fault, 16, 4, 4, 3};
	assert_int_equal(display_submit(&display, &buffer, 42, &fault), -EINVAL);
	record.acquire_result = -EAGAIN;
	assert_int_equal(display_acquire(&display, &buffer), -EAGAIN);
	record.acquire_result = 0;
	assert_int_equal(display_acquire(&display, &buffer), 0);
	copy = buffer;
	copy.index = 2;
	assert_int_equal(display_submit(&display, &copy, 42, &fault), -EINVAL);
	copy = buffer;
	assert_int_equal(display_submit(&display, &buffer, 42, &fault), 0);
	assert_null(buffer.pixels);
	/* a buffer that was given back cannot be submitted */
	assert_int_equal(display_submit(&display, &copy, 42, &fault), -EINVAL);
	assert_int_equal(record.submitted, 1);
	record.next = DISPLAY_ACTION;
	assert_int_equal(display_dispatch(&display, &event, &fault), 0);
	assert_int_equal(display.shown, 0);
	record.next = DISPLAY_SHOWN;
	assert_int_equal(display_dispatch(&display, &event, &fault), 0);
	assert_int_equal(display.shown, 1);
	assert_int_equal(display_dispatch(&display, &event, &fault), 0);
	assert_int_equal(event.kind, DISPLAY_NOTHING);
	assert_int_equal(display_close(&display, &fault), -ENOSPC);
	assert_string_equal(fault.text, "torn");
	assert_int_equal(display_close(&display, &fault), 0);
	assert_int_equal(record.closed, 1);
}

/* A driver that returns only an error gets its situation from the wrapper. */
TEST("wrappers name situations")
{
	static const struct {
		int err;
		enum display_situation situation;
		bool may_return;
	} cases[] = {
		{-ENODEV, DISPLAY_NO_DEVICE, true},
		{-ENOLINK, DISPLAY_NO_SCREEN, true},
		{-EBUSY, DISPLAY_BUSY, true},
		{-ETIMEDOUT, DISPLAY_STALLED, true},
		{-EACCES, DISPLAY_NO_PERMISSION, false},
		{-EPERM, DISPLAY_NO_PERMISSION, false},
		{-EIO, DISPLAY_BROKEN, false},
		{-ENOTSUP, DISPLAY_BROKEN, false},
	};
	const struct display_settings settings = {.width = 4};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct display_record record = {.open_result = cases[i].err};
		struct display display;

		assert_int_equal(display_open(&display, &recorder, &settings, &record, NULL),
				 cases[i].err);
		assert_int_equal(display.situation, cases[i].situation);
		assert_int_equal(display_may_return(display.situation), cases[i].may_return);
		assert_int_equal(display_fit(&display, 4, 4, 1), -EBADF);
		/* kept after close, until the display is opened again */
		display_close(&display, NULL);
		assert_int_equal(display.situation, cases[i].situation);
		record.open_result = 0;
		assert_int_equal(display_open(&display, &recorder, &settings, &record, NULL), 0);
		assert_int_equal(display.situation, DISPLAY_FINE);
		/* most drivers leave scaling to the program */
		assert_int_equal(display_fit(&display, 4, 4, 1), -ENOTSUP);
		display.hidden = true;
		display_close(&display, NULL);
		assert_false(display.hidden);
	}
}

/* ---- what the drivers share ---- */

static void open_fine(struct display *display, const struct display_ops *ops,
		      const struct display_settings *settings, void *options)
{
	struct fault fault;

	if (display_open(display, ops, settings, options, &fault))
		fail_msg("%s", fault.text);
}

static void close_fine(struct display *display)
{
	struct fault fault;

	if (display_close(display, &fault))
		fail_msg("%s", fault.text);
}

/* Waits, on the descriptor alone, for the submitted frame. */
static struct display_event wait_shown(struct display *display)
{
	struct pollfd ready = {.fd = display_descriptor(display), .events = POLLIN};
	struct display_event event;
	struct fault fault;

	do {
		assert_int_equal(poll(&ready, 1, 60000), 1);
		assert_int_equal(display_dispatch(display, &event, &fault), 0);
	} while (event.kind == DISPLAY_NOTHING);
	assert_int_equal(event.kind, DISPLAY_SHOWN);
	return event;
}

/* A chart without symmetry: red grows to the right, green downwards. */
static void test_display_draw(const struct display_buffer *buffer, int number)
{
	for (int y = 0; y < buffer->height; y++)
		for (int x = 0; x < buffer->width; x++) {
			uint8_t *p = buffer->pixels + (size_t)y * buffer->stride + 4 * x;

			p[0] = (uint8_t)(number * 10);
			p[1] = (uint8_t)(y * 255 / (buffer->height - 1));
			p[2] = (uint8_t)(x * 255 / (buffer->width - 1));
			p[3] = 255;
		}
}

static void test_display_show(struct display *display, int number)
{
	struct display_buffer buffer;
	struct fault fault;

	assert_int_equal(display_acquire(display, &buffer), 0);
	test_display_draw(&buffer, number);
	if (display_submit(display, &buffer, number, &fault))
		fail_msg("%s", fault.text);
	assert_int_equal(wait_shown(display).token, number);
}

/* ---- null ---- */

/* The driver's own options. */
struct null_choice {
	int vanish_after, stall_after, hide_after;
};

TEST("null flips on time")
{
	const struct display_settings settings = {
		.picture_width = 64, .picture_height = 48, .rate_hz = 125}; /* 8 ms */
	struct null_choice choice = {.hide_after = 0};
	struct display_event event = {0}, nothing;
	struct display display;
	struct display_buffer buffer, again;
	struct fault fault;
	int64_t first_ns = 0;
	int last_index = -1;

	open_fine(&display, &display_null, &settings, &choice);
	assert_int_equal(display.width, 64);
	assert_int_equal(display.height, 48);
	for (int i = 0; i < 12; i++) {
		struct pollfd quiet = {.fd = display_descriptor(&display), .events = POLLIN};
		int64_t before_ns;

		/* idle, the display wakes nobody */
		assert_int_equal(poll(&quiet, 1, 0), 0);
		assert_int_equal(display_acquire(&display, &buffer), 0);
		assert_int_equal(display_acquire(&display, &again), 0);
		assert_ptr_equal(again.pixels, buffer.pixels);
		assert_int_not_equal(buffer.index, last_index);
		last_index = buffer.index;
		test_display_draw(&buffer, i);
		before_ns = clock_now_ns();
		assert_int_equal(display_submit(&display, &buffer, 1000 + i, &fault), 0);
		/* one buffer is on the screen, the other queued */
		assert_int_equal(display_acquire(&display, &again), -EAGAIN);
		event = wait_shown(&display);
		assert_int_equal(event.token, 1000 + i);
		assert_true(event.time_ns > before_ns - NS_PER_MS);
		assert_true(event.time_ns <= clock_now_ns());
		if (!i)
			first_ns = event.time_ns;
		assert_int_equal((event.time_ns - first_ns) % (8 * NS_PER_MS), 0);
	}
	assert_true(event.time_ns - first_ns >= 11 * 8 * NS_PER_MS);
	assert_int_equal(display.shown, 12);
	assert_int_equal(display_dispatch(&display, &nothing, &fault), 0);
	assert_int_equal(nothing.kind, DISPLAY_NOTHING);
	close_fine(&display);
	close_fine(&display);
}

TEST("null without size")
{
	const struct display_settings settings = {.rate_hz = 50};
	struct null_choice choice = {.hide_after = 0};
	struct display display;
	struct fault fault;

	assert_int_equal(display_open(&display, &display_null, &settings, &choice, &fault),
			 -EINVAL);
	assert_non_null(strstr(fault.text, "size"));
}

/* Each time that it is opened it shows so many frames, then the fault, and not before. */
TEST("null fails when told")
{
	static const struct {
		struct null_choice choice;
		int err;
		enum display_situation situation;
		int64_t least_ns;
	} cases[] = {
		{{.vanish_after = 3}, -ENOLINK, DISPLAY_NO_SCREEN, 0},
		{{.stall_after = 3}, -ETIMEDOUT, DISPLAY_STALLED, NS_PER_S},
	};
	const struct display_settings settings = {.width = 8, .height = 8};

	for (int i = 0; i < 4; i++) {
		struct null_choice choice = cases[i / 2].choice;
		struct pollfd ready = {.events = POLLIN};
		struct display display;
		struct display_buffer buffer;
		struct display_event event;
		struct fault fault;
		int64_t start_ns;

		open_fine(&display, &display_null, &settings, &choice);
		for (int n = 0; n < 3; n++)
			test_display_show(&display, n);
		assert_int_equal(display_acquire(&display, &buffer), 0);
		assert_int_equal(display_submit(&display, &buffer, 3, &fault), 0);
		start_ns = clock_now_ns();
		ready.fd = display_descriptor(&display);
		assert_int_equal(poll(&ready, 1, 60000), 1);
		assert_int_equal(display_dispatch(&display, &event, &fault), cases[i / 2].err);
		assert_int_equal(event.kind, DISPLAY_NOTHING);
		assert_int_equal(display.situation, cases[i / 2].situation);
		assert_true(clock_now_ns() - start_ns >= cases[i / 2].least_ns);
		close_fine(&display);
	}
}

/* The console is switched away during a frame, and back. */
TEST("null hides when told")
{
	const struct display_settings settings = {.width = 8, .height = 8};
	struct null_choice choice = {.hide_after = 3};
	struct pollfd ready = {.events = POLLIN};
	struct display display;
	struct display_buffer buffer;
	struct display_event event;
	struct fault fault;

	open_fine(&display, &display_null, &settings, &choice);
	for (int n = 0; n < 3; n++)
		test_display_show(&display, n);
	assert_int_equal(display_acquire(&display, &buffer), 0);
	assert_int_equal(display_submit(&display, &buffer, 3, &fault), 0);
	ready.fd = display_descriptor(&display);
	assert_int_equal(poll(&ready, 1, 60000), 1);
	assert_int_equal(display_dispatch(&display, &event, &fault), 0);
	assert_int_equal(event.kind, DISPLAY_NOTHING);
	assert_true(display.hidden);
	assert_int_equal(display_acquire(&display, &buffer), -EAGAIN);
	assert_int_equal(poll(&ready, 1, 60000), 1);
	assert_int_equal(display_dispatch(&display, &event, &fault), 0);
	assert_int_equal(event.kind, DISPLAY_EXPOSED);
	assert_false(display.hidden);
	assert_int_equal(display.shown, 3);
	for (int n = 4; n < 7; n++)
		test_display_show(&display, n);
	assert_int_equal(display.shown, 6);
	close_fine(&display);
}

/* ---- file ---- */

static void file_settings(struct display_settings *settings, const char *name)
{
	*settings = (struct display_settings){.picture_width = 33, .picture_height = 17};
	snprintf(settings->device, sizeof(settings->device), "%s/%s", own_folder(), name);
}

static size_t files_in_folder(void)
{
	char pattern[64];
	glob_t found = {0};
	size_t count;

	snprintf(pattern, sizeof(pattern), "%s/*", own_folder());
	glob(pattern, 0, NULL, &found);
	count = found.gl_pathc;
	globfree(&found);
	return count;
}

/* ITU-R BT.601, limited range, in double precision. */
static void bt601(const double rgb[3], double yuv[3])
{
	const double y = 0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2];

	yuv[0] = 16 + y * 219 / 255;
	yuv[1] = 128 + (rgb[2] - y) / 1.772 * 224 / 255;
	yuv[2] = 128 + (rgb[0] - y) / 1.402 * 224 / 255;
}

TEST("file video")
{
	static const char header[] = "YUV4MPEG2 W33 H17 F25:1 Ip A1:1 C444 XCOLORRANGE=LIMITED\n";
	struct display_settings settings;
	struct display display;
	static uint8_t file[4096];
	const size_t plane = 33 * 17, frame = 6 + 3 * plane;
	FILE *stream;

	file_settings(&settings, "clip.y4m");
	settings.rate_hz = 25;
	open_fine(&display, &display_file, &settings, NULL);
	test_display_show(&display, 0);
	test_display_show(&display, 1);
	assert_int_equal(access(settings.device, F_OK), -1);
	close_fine(&display);
	stream = fopen(settings.device, "rb");
	assert_non_null(stream);
	assert_int_equal(fread(file, 1, sizeof(file), stream), sizeof(header) - 1 + 2 * frame);
	fclose(stream);
	assert_memory_equal(file, header, sizeof(header) - 1);
	for (int n = 0; n < 2; n++) {
		const uint8_t *at = file + sizeof(header) - 1 + (size_t)n * frame;

		assert_memory_equal(at, "FRAME\n", 6);
		for (int i = 0; i < 33 * 17; i++) {
			const double rgb[3] = {i % 33 * 255 / 32, i / 33 * 255 / 16, 10 * n};
			double yuv[3];

			bt601(rgb, yuv);
			for (int c = 0; c < 3; c++)
				assert_true(fabs(at[6 + (size_t)c * plane + (size_t)i] - yuv[c]) <=
					    1.5);
		}
	}
	unlink(settings.device);
	assert_int_equal(files_in_folder(), 0);
}

TEST("file video fraction")
{
	struct display_settings settings;
	struct display display;
	char line[128];
	FILE *stream;

	file_settings(&settings, "clip.y4m");
	settings.rate_hz = 30000.0 / 1001;
	open_fine(&display, &display_file, &settings, NULL);
	test_display_show(&display, 0);
	close_fine(&display);
	stream = fopen(settings.device, "rb");
	assert_non_null(stream);
	assert_non_null(fgets(line, sizeof(line), stream));
	fclose(stream);
	assert_non_null(strstr(line, " F29970:1000 "));
	unlink(settings.device);
	/* a frame that was not shown leaves no file */
	open_fine(&display, &display_file, &settings, NULL);
	close_fine(&display);
	assert_int_equal(files_in_folder(), 0);
}

static void check_picture(const char *path, int number)
{
	struct image image;
	struct fault fault;

	if (image_read(path, &image, &fault))
		fail_msg("%s", fault.text);
	assert_int_equal(image.width, 33);
	assert_int_equal(image.height, 17);
	for (int i = 0; i < 33 * 17; i++) {
		assert_int_equal(image.u8[3 * i], i % 33 * 255 / 32);
		assert_int_equal(image.u8[3 * i + 1], i / 33 * 255 / 16);
		assert_int_equal(image.u8[3 * i + 2], 10 * number);
	}
	image_free(&image);
}

TEST("file pictures")
{
	static const char *const names[] = {"out%03d.png", "a%dz.png", "now.png"};

	for (int k = 0; k < 3; k++) {
		struct display_settings settings;
		struct display display;

		file_settings(&settings, names[k]);
		open_fine(&display, &display_file, &settings, NULL);
		for (int n = 0; n < 3; n++) {
			char name[32], path[64];

			test_display_show(&display, n);
			switch (k) {
			case 0:
				snprintf(name, sizeof(name), "out%03d.png", n);
				break;
			case 1:
				snprintf(name, sizeof(name), "a%dz.png", n);
				break;
			default:
				strcpy(name, "now.png");
			}
			snprintf(path, sizeof(path), "%s/%s", own_folder(), name);
			check_picture(path, n);
			if (k < 2)
				unlink(path);
		}
		close_fine(&display);
		if (k == 2)
			unlink(settings.device);
		assert_int_equal(files_in_folder(), 0);
	}
}

TEST("file bad names")
{
	static const char *const names[] = {"clip.avi",	   "out",	  "%s.png",   "%d%d.png",
					    "out%04n.png", "out%.3d.png", "100%.png", "a%99d.png"};

	for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
		struct display_settings settings;
		struct display display;
		struct fault fault;

		file_settings(&settings, names[i]);
		assert_int_equal(display_open(&display, &display_file, &settings, NULL, &fault),
				 -EINVAL);
		assert_non_null(strstr(fault.text, names[i]));
		assert_non_null(strstr(fault.text, "out%04d.png"));
	}
	{
		struct display_settings settings;
		struct display display;
		struct fault fault;

		file_settings(&settings, "none/clip.y4m");
		assert_int_equal(display_open(&display, &display_file, &settings, NULL, &fault),
				 -ENOENT);
	}
	assert_int_equal(files_in_folder(), 0);
}

/* A full disk: no file may grow beyond 64 kB. */
TEST("file disk full")
{
	struct rlimit old, small;
	struct display_settings settings;
	struct display display;
	struct display_buffer buffer;
	struct display_event event;
	struct fault fault = {0};
	int err = 0;

	signal(SIGXFSZ, SIG_IGN);
	assert_int_equal(getrlimit(RLIMIT_FSIZE, &old), 0);
	small = old;
	small.rlim_cur = 1 << 16;
	file_settings(&settings, "clip.y4m");
	settings.picture_width = settings.picture_height = 128;
	open_fine(&display, &display_file, &settings, NULL);
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
	for (int i = 0; i < 10 && !err; i++) {
		assert_int_equal(display_acquire(&display, &buffer), 0);
		test_display_draw(&buffer, i);
		err = display_submit(&display, &buffer, i, &fault);
		if (!err)
			assert_int_equal(display_dispatch(&display, &event, &fault), 0);
	}
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &old), 0);
	assert_int_equal(err, -EFBIG);
	assert_non_null(strstr(fault.text, "clip.y4m"));
	close_fine(&display);
	assert_int_equal(files_in_folder(), 0);
}

/* ---- window ---- */

#if WITH_SDL
TEST("window shows")
{
	const struct display_settings settings = {.picture_width = 40, .picture_height = 30};
	struct display display;
	SDL_Renderer *renderer = NULL;
	uint8_t pixels[40 * 30 * 4];

	setenv("SDL_VIDEODRIVER", "dummy", 1);
	open_fine(&display, &display_window, &settings, NULL);
	for (int n = 0; n < 3; n++)
		test_display_show(&display, n);
	for (Uint32 id = 0; id < 16 && !renderer; id++)
		renderer = SDL_GetWindowFromID(id) ? SDL_GetRenderer(SDL_GetWindowFromID(id))
						   : NULL;
	assert_non_null(renderer);
	assert_int_equal(
		SDL_RenderReadPixels(renderer, NULL, SDL_PIXELFORMAT_ARGB8888, pixels, 160), 0);
	for (int i = 0; i < 40 * 30; i++) {
		assert_int_equal(pixels[4 * i], 20);
		assert_int_equal(pixels[4 * i + 1], i / 40 * 255 / 29);
		assert_int_equal(pixels[4 * i + 2], i % 40 * 255 / 39);
	}
	close_fine(&display);
}

static struct display_event next_event(struct display *display)
{
	struct display_event event;
	struct fault fault;

	do
		assert_int_equal(display_dispatch(display, &event, &fault), 0);
	while (event.kind == DISPLAY_NOTHING && SDL_HasEvents(SDL_FIRSTEVENT, SDL_LASTEVENT));
	return event;
}

TEST("window keys")
{
	static const struct {
		SDL_Keycode key;
		enum action action;
	} keys[] = {
		{SDLK_PLUS, ACTION_THRESHOLD_UP},
		{SDLK_MINUS, ACTION_THRESHOLD_DOWN},
		{SDLK_v, ACTION_VIEW_NEXT},
		{SDLK_o, ACTION_OBJECT},
		{SDLK_f, ACTION_FREEZE},
		{SDLK_p, ACTION_POSE_NEXT},
		{SDLK_q, ACTION_QUIT},
		{SDLK_x, ACTION_NONE},
	};
	const struct display_settings settings = {.picture_width = 40, .picture_height = 30};
	struct display display;
	SDL_Event press = {.type = SDL_KEYDOWN};

	setenv("SDL_VIDEODRIVER", "dummy", 1);
	open_fine(&display, &display_window, &settings, NULL);
	while (next_event(&display).kind != DISPLAY_NOTHING)
		;
	for (size_t i = 0; i < sizeof(keys) / sizeof(keys[0]); i++) {
		struct display_event event;

		press.key.keysym.sym = keys[i].key;
		assert_int_equal(SDL_PushEvent(&press), 1);
		event = next_event(&display);
		assert_int_equal(event.kind,
				 keys[i].action == ACTION_NONE ? DISPLAY_NOTHING : DISPLAY_ACTION);
		assert_int_equal(event.action, keys[i].action);
	}
	press.key.keysym.sym = SDLK_ESCAPE;
	SDL_PushEvent(&press);
	assert_int_equal(next_event(&display).kind, DISPLAY_CLOSED);
	press.type = SDL_QUIT;
	SDL_PushEvent(&press);
	assert_int_equal(next_event(&display).kind, DISPLAY_CLOSED);
	close_fine(&display);
}
#endif

/* ---- kms ---- */

#if WITH_KMS
/* Refresh rate of CTA-861's modes: clock / (htotal * vtotal). */
static const drmModeModeInfo modes[] = {
	{.clock = 74250,
	 .hdisplay = 1920,
	 .vdisplay = 1080,
	 .htotal = 2200,
	 .vtotal = 1125,
	 .flags = DRM_MODE_FLAG_INTERLACE}, /* 60 fields a second */
	{.clock = 148500, .hdisplay = 1920, .vdisplay = 1080, .htotal = 2640, .vtotal = 1125},
	{.clock = 148500, .hdisplay = 1920, .vdisplay = 1080, .htotal = 2200, .vtotal = 1125},
	{.clock = 148352, .hdisplay = 1920, .vdisplay = 1080, .htotal = 2200, .vtotal = 1125},
	{.clock = 74250,
	 .hdisplay = 1280,
	 .vdisplay = 720,
	 .htotal = 1650,
	 .vtotal = 750,
	 .type = DRM_MODE_TYPE_PREFERRED},
	{.clock = 74250, .hdisplay = 1280, .vdisplay = 720, .htotal = 1980, .vtotal = 750},
	{.clock = 25175, .hdisplay = 640, .vdisplay = 480, .htotal = 800, .vtotal = 525},
};

TEST("kms rates")
{
	static const double expected[] = {60, 50, 60, 59.940, 60, 50, 59.940};

	for (int i = 0; i < 7; i++)
		assert_true(fabs(kms_mode_rate(&modes[i]) - expected[i]) < 1e-3);
	assert_true(kms_mode_rate(&(drmModeModeInfo){0}) == 0);
}

TEST("kms modes")
{
	static const struct {
		int width, height;
		double rate_hz;
		int expected;
	} cases[] = {
		{0, 0, 0, 4},				 /* the preferred one */
		{0, 0, 50, 5},				 /* of that size, the nearest rate */
		{0, 0, 1000, 4},     {1920, 1080, 0, 1}, /* not the interlaced one */
		{1920, 1080, 60, 2}, {1920, 1080, 59.94, 3}, {1920, 1080, 49, 1},
		{1920, 0, 60, 2},    {0, 720, 50, 5},	     {640, 480, 75, 6},
		{1280, 720, 0, 4},   {1024, 768, 0, -1},     {1920, 720, 0, -1},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++)
		assert_int_equal(kms_mode_choose(modes, 7, cases[i].width, cases[i].height,
						 cases[i].rate_hz),
				 cases[i].expected);
	/* without a preferred mode the first progressive one; without any mode, none */
	assert_int_equal(kms_mode_choose(modes, 4, 0, 0, 0), 1);
	assert_int_equal(kms_mode_choose(modes, 1, 0, 0, 0), -1);
	assert_int_equal(kms_mode_choose(modes, 0, 0, 0, 0), -1);
}

TEST("kms refusals")
{
	static const struct {
		const char *device;
		int err;
		const char *word;
	} cases[] = {{"/dev/dri/card99", -ENOENT, "/dev/dri/card99"},
		     {"/dev/null", -ENOTSUP, "not a graphics card"}};
	struct kms_options options = {.buffers = 2};

	for (int i = 0; i < 2; i++) {
		struct display_settings settings = {0};
		struct display display;
		struct fault fault;

		strcpy(settings.device, cases[i].device);
		assert_int_equal(display_open(&display, &display_kms, &settings, &options, &fault),
				 cases[i].err);
		assert_non_null(strstr(fault.text, cases[i].word));
	}
}
#endif

TEST_GROUP(own_folder_make, own_folder_remove);
