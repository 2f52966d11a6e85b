/* SPDX-License-Identifier: MIT */
/*
 * A V4L2 device that the test plays: the driver opens and maps an ordinary file, and __wrap_ioctl()
 * answers instead of a kernel. This is for answers that no healthy driver gives on demand; tests/vm
 * is about what a real kernel answers.
 *
 * Programs that use it are linked with -Wl,--wrap=ioctl -Wl,--wrap=epoll_ctl (../module.mk). The
 * memory of each plane begins with a byte of its own, buffer * 2 + plane + 1.
 */
#ifndef INLAY_TESTS_SUPPORT_PLAYED_V4L2_H
#define INLAY_TESTS_SUPPORT_PLAYED_V4L2_H

#include <linux/videodev2.h>
#include <stdbool.h>
#include <stdint.h>

#include "drivers/v4l2/v4l2.h"
#include "hal/base/fault.h"
#include "hal/device/camera.h"

enum {
	PLAYED_BUFFERS_MAX = 16,
	PLAYED_BUFFER_BYTES = 65536,
	PLAYED_QUEUE = 16,
	PLAYED_CONTROLS_MAX = 8,
	PLAYED_CONTROL = 0x980900, /* id of the first control; the n-th has PLAYED_CONTROL + n */
	PLAYED_YUYV_BYTES = 64 * 48 * 2,
};

/* A picture that the device has ready. */
struct played_picture {
	int buffer;
	uint32_t sequence, flags, field, bytes[2], data_offset;
	int64_t time_ns; /* CLOCK_MONOTONIC; 0: now */
};

struct played_control {
	const char *name;
	uint32_t type, flags;
	int minimum, maximum, value;
	int most;   /* larger values become this one; 0: no such limit */
	int step;   /* values are rounded to multiples; 0: not rounded */
	int refuse; /* errno of setting the control; 0: none */
	int sets;   /* how often the control was set */
};

struct played_device {
	const uint32_t *formats; /* four-character codes, 0 at the end */
	bool multiplanar, no_capture;
	unsigned width, height, stride_extra, colorspace, encoding, quantization, rate;
	uint32_t fourcc, field;
	bool sizes_known;    /* lists 64x48 and 32x24, and rates; only MJPEG is fast */
	double room;	     /* bits a second that the bus has left; 0: enough */
	bool room_at_format; /* S_FMT already fails for want of room, else STREAMON */
	/* errno of these calls, 0: none; and how many calls fail with EINTR first */
	int streamon_error, dequeue_error, signal_error, timings_error, interrupts;
	bool dv_timings, television;
	bool tells;	 /* source-change events can be subscribed to */
	uint32_t status; /* of the input */
	v4l2_std_id detected, standard;
	int input, events;
	struct played_control controls[PLAYED_CONTROLS_MAX];
	bool resets; /* the first control goes back to its minimum when streaming starts */
	bool held;   /* another program streams */
	bool streaming;
	int buffers;
	int changes; /* how often input or standard was set */
	bool queued[PLAYED_BUFFERS_MAX];
	struct played_picture ready[PLAYED_QUEUE];
	int ready_count;
	uint32_t timestamp_flags;
};

/* The device; a test changes it between the calls below. */
extern struct played_device played;

/* The device's file, while the group runs. */
extern char played_path[];
extern int played_file;

extern const uint32_t played_formats[]; /* MJPEG, NV12, YUYV and one that inlay does not read */

struct played_rig {
	struct camera camera;
	struct camera_settings settings;
	struct fault fault;
	struct v4l2_options options;
};

/* Setup and teardown of a group: the file. */
int played_make_file(void **state);
int played_remove_file(void **state);

/* Resets device and rig: 64 x 48 at 5 Hz, progressive, four buffers. */
void played_prepare(struct played_rig *rig, const uint32_t *formats);

/* Opens the camera: what camera_open() returns. must_start fails the test instead. */
int played_start(struct played_rig *rig);
void played_must_start(struct played_rig *rig);

/* Closes the camera, twice, and checks that the device is idle. */
void played_finish(struct played_rig *rig);

/* Adds a picture to those that are ready; the caller may change it. */
struct played_picture *played_deliver(int buffer, uint32_t sequence, uint32_t bytes,
				      uint32_t flags);

/* Number of buffers that the driver has queued. */
int played_queued(void);

#endif
