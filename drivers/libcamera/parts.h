/* SPDX-License-Identifier: MIT */
/* The parts of the driver that know no type of libcamera's, so that tests need no camera. */
#ifndef INLAY_DRIVERS_LIBCAMERA_PARTS_H
#define INLAY_DRIVERS_LIBCAMERA_PARTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "hal/base/fault.h"
#include "hal/device/camera.h"
#include "hal/frame/frame.h"

/*
 * Controls of a camera as numbers and text: what may be set, what the configuration asks for (the
 * wishes), and what the camera makes of them. No type of libcamera's, so that tests need no camera.
 */

enum { LIBCAMERA_NUMBERS_MAX = 16, LIBCAMERA_WISHES_MAX = 33, LIBCAMERA_VALUE_TEXT_MAX = 256 };

enum libcamera_kind {
	LIBCAMERA_OTHER, /* not numeric: a rectangle, a text */
	LIBCAMERA_BOOL,
	LIBCAMERA_BYTE,
	LIBCAMERA_INT32,
	LIBCAMERA_INT64, /* limited to the integers that a double holds exactly, 2^53 */
	LIBCAMERA_FLOAT,
};

struct libcamera_value {
	enum libcamera_kind kind;
	int count; /* 0: not known */
	double numbers[LIBCAMERA_NUMBERS_MAX];
};

/* A control that the camera has. */
struct libcamera_control {
	const void *theirs; /* lc::ControlId, opaque here; passed to the callbacks */
	char name[CAMERA_CONTROL_NAME_MAX];
	enum libcamera_kind kind;
	int elements; /* length of an array; 0: a single value */
	struct libcamera_value least, most;
	/* Converts one of the control's named values to its number. False: no such name. May be
	 * NULL. */
	bool (*number_of)(const void *theirs, const char *word, double *number);
};

/* Convert between a value and its elements in memory: bytes, integers or floats of the machine.
 * Elements of an array beyond LIBCAMERA_NUMBERS_MAX are ignored. */
void libcamera_value_unpack(struct libcamera_value *value, enum libcamera_kind kind, int count,
			    const void *elements);
void libcamera_value_pack(const struct libcamera_value *value, void *elements);

/* Writes the numbers with blanks between; empty if the value has none. */
void libcamera_value_text(const struct libcamera_value *value, char text[LIBCAMERA_VALUE_TEXT_MAX]);

/* Reads numbers or named values with blanks between. 0; -EINVAL, -ERANGE with a fault. */
int libcamera_value_read(const struct libcamera_control *control, const char *text,
			 struct libcamera_value *value, struct fault *fault);

struct libcamera_wish {
	const struct libcamera_control *control; /* borrowed */
	struct libcamera_value value;
	bool granted; /* the camera reported this value */
};

struct libcamera_wishes {
	const char *camera; /* its name, for messages; borrowed */
	struct libcamera_wish list[LIBCAMERA_WISHES_MAX];
	int count, next; /* list[next] is the first that no request carries yet */
	bool alone;	 /* each request carries one wish only */
	int settling;	 /* frames until the values that the camera reports are final */
};

/* Reads camera_settings.controls and .rate_hz (0: none). Wishes that cannot be met are logged and
 * left out. Returns the frame rate in Hz that will be held; 0: the camera cannot set one. */
double libcamera_wishes_read(struct libcamera_wishes *wishes, const char *camera,
			     const struct libcamera_control *known, int count, const char *text,
			     double rate_hz);

/* Changes a control while the camera runs: the next request that is queued carries it. 0; -EINVAL:
 * no such control; -EINVAL, -ERANGE as libcamera_value_read(); -E2BIG: too many wishes. */
int libcamera_wishes_change(struct libcamera_wishes *wishes, const struct libcamera_control *known,
			    int count, const char *name, const char *value, struct fault *fault);

/* A part of the list of wishes, which one request carries. */
struct libcamera_load {
	int first, count;
};

/* Returns what the next request carries: all wishes at first, then none; after the camera has
 * refused several wishes together, one at a time. */
struct libcamera_load libcamera_wishes_next(struct libcamera_wishes *wishes);

/* Tells that a request which carried this load failed. */
void libcamera_wishes_refused(struct libcamera_wishes *wishes, struct libcamera_load load);

/* Compares the wishes with what the camera used for a frame. get() fetches the value of a control;
 * false: not reported. Differences are logged once the camera has had time to settle. */
void libcamera_wishes_compare(struct libcamera_wishes *wishes,
			      bool (*get)(const void *context, const void *theirs,
					  struct libcamera_value *value),
			      const void *context);

/*
 * Events of a running camera behind one descriptor, passed from libcamera's thread to the caller's:
 * completed requests, and the loss of the camera.
 */

enum { LIBCAMERA_REQUESTS_MAX = 64, LIBCAMERA_NODES_MAX = 256 };

struct libcamera_events {
	int descriptor;			 /* epoll: readable when there is an event */
	int done[2];			 /* pipe: one byte for each completed request */
	int dev;			 /* inotify: watches /dev */
	bool nodes[LIBCAMERA_NODES_MAX]; /* whether /dev/videoN belongs to the camera */
	bool over, gone;		 /* no more requests will complete; a node was deleted */
};

/* 0 or -errno. After a failure there is nothing to close. */
int libcamera_events_open(struct libcamera_events *events, struct fault *fault);
void libcamera_events_close(struct libcamera_events *events);

/* Watches the video nodes of the camera: libcamera reports the loss of webcams only. own() says
 * whether a device number belongs to the camera. */
int libcamera_events_watch(struct libcamera_events *events,
			   bool (*own)(const void *context, dev_t number), const void *context,
			   struct fault *fault);

/* Any thread may call these: a request, 0..LIBCAMERA_REQUESTS_MAX-1, is completed; no more will
 * be. */
void libcamera_events_done(struct libcamera_events *events, int request);
void libcamera_events_end(struct libcamera_events *events);

/* Takes the oldest completed request and returns its index. -EAGAIN: none now; -ENODEV: no more
 * will come. */
int libcamera_events_take(struct libcamera_events *events);

/* Whether a watched node has been deleted. */
bool libcamera_events_deleted(struct libcamera_events *events);

/* Waits up to 300 ms for libcamera_events_end(): libcamera learns of a lost device later than
 * inotify does, or never. Returns whether it came. Requests that complete meanwhile are lost. */
bool libcamera_events_end_soon(struct libcamera_events *events);

/* Finds the camera that a name in the configuration means. */

struct libcamera_name {
	const char *id, *model;
};

/* Finds a camera by id, else by model, else by a part of either; an empty name means the first one.
 * Returns an index, or -errno with a fault: -EINVAL more than one fits, -ENODEV none, -EACCES none
 * that this user may open. */
int libcamera_find(const struct libcamera_name *cameras, int count, const char *wanted,
		   struct fault *fault);

/* Keeps news of devices from a running libcamera where the news would crash it. */

/*
 * Returns how many new devices have been kept from libcamera. A manager finds all devices when it
 * starts and is not told of later ones: libcamera (0.0.3, devMap_ of DeviceEnumeratorUdev) keeps
 * pointers to freed memory for each device that it has seen. It follows them when udev reports a
 * video node of that device before its media node, as happens after plugging in again or when udev
 * is late. Lost messages of udev count as one new device.
 */
unsigned libcamera_hotplug_kept(void);

/* Passes messages of libcamera's log on to inlay's. */

/* Logs one whole message, "[time] [thread] LEVEL Category file:line text": errors as warnings, the
 * rest for debugging. A repeated message (a lost device fails at every frame) is logged once. Any
 * thread may call it. */
void libcamera_message(const char *text, size_t length);

/* Pictures in libcamera's buffers: mapped memory, the planes in it, the time of capture. */

/* A plane as libcamera describes it: a range of bytes of a descriptor. Planes may share one. */
struct libcamera_span {
	int fd;
	size_t offset, bytes;
};

/* If zeroed, nothing is mapped. */
struct libcamera_picture {
	enum pixel_format format;
	int width, height;
	struct frame_plane planes[FRAME_PLANES];
	struct {
		int fd; /* borrowed */
		void *memory;
		size_t length;
	} mappings[FRAME_PLANES];
	int mapping_count;
};

/* Maps a buffer for reading and points the planes of picture->format, width and height into it.
 * stride: of the first. Planes that libcamera does not describe follow each other in memory.
 * -EINVAL: the spans are too small for the picture; other -errno: they cannot be mapped. The caller
 * unmaps the picture after a failure too. */
int libcamera_picture_map(struct libcamera_picture *picture, size_t stride,
			  const struct libcamera_span *spans, int count);
void libcamera_picture_unmap(struct libcamera_picture *picture); /* idempotent */

/* Call it before and after the processor reads a picture, to keep its cache coherent
 * (DMA_BUF_SYNC). Memory that is not a DMABUF refuses the ioctl and does not need it; this is no
 * error. */
void libcamera_picture_reading(const struct libcamera_picture *picture, bool begins);

/* Fills in the planes of a picture; used[] are the bytes that each span holds. False: the picture
 * is not whole. */
bool libcamera_picture_planes(const struct libcamera_picture *picture, const size_t *used,
			      int count, struct frame_plane planes[FRAME_PLANES]);

/* Converts a time stamp to CLOCK_MONOTONIC. Some pipelines stamp with that clock, as V4L2 does,
 * others with CLOCK_BOOTTIME, as libcamera's documentation says; they differ by the time of
 * suspension. For a stamp of neither clock it returns the present time. */
int64_t libcamera_picture_time_ns(int64_t stamp_ns);

#endif
