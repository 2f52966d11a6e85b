/* SPDX-License-Identifier: MIT */
/*
 * Cameras: the contract between the program and drivers/camera_*.c.
 *
 * Callers use the wrappers below, never the pointers. One thread owns a camera. A camera is opened
 * from settings that never change, and holds run-time state apart from them.
 */
#ifndef INLAY_HAL_DEVICE_CAMERA_H
#define INLAY_HAL_DEVICE_CAMERA_H

#include <stdbool.h>
#include <stdio.h>

#include "hal/base/fault.h"
#include "hal/frame/frame.h"
#include "hal/ini/ini.h"

/* What a screen can say about a camera. */
enum camera_situation {
	CAMERA_FINE,
	CAMERA_NO_DEVICE,
	CAMERA_NO_SIGNAL,
	CAMERA_STALLED,
	CAMERA_UNSUPPORTED_FORMAT,
	CAMERA_BUSY,
	CAMERA_NO_BANDWIDTH,
	CAMERA_NO_PERMISSION,
	CAMERA_BROKEN, /* anything else; the fault says what */
	CAMERA_SITUATION_COUNT
};

extern const char *const camera_situation_names[]; /* "fine", "no device", ... NULL */

struct camera_settings {
	char device[INI_PATH_MAX]; /* driver's own meaning; empty: the first found */
	int width, height;	   /* wanted; 0: the driver's choice */
	double rate_hz;		   /* wanted; 0: the driver's choice */
	int format;  /* enum pixel_format wanted; PIXEL_NONE: the cheapest to convert */
	int buffers; /* 2..8 */
	int matrix;  /* enum colour_matrix + 1; 0: as the driver says */
	int range;   /* enum colour_range + 1; 0: as the driver says */
	/* "name=value, name=value", names and values as `devices` lists them; set after every
	 * opening and read back. A refusal is logged and does not keep the camera from opening. */
	char controls[INI_TEXT_MAX];
	/* What may be given up, in this order, when the bus has no room for what is wanted: words
	 * of "format", "size", "rate"; empty: nothing. */
	char give_up[INI_TEXT_MAX];
};

struct camera_ops;

struct camera {
	const struct camera_ops *ops;
	struct camera_settings settings;
	void *options;	/* the driver's own struct, ops->options_size bytes; borrowed */
	char name[128]; /* what the device calls itself; empty: not known. Kept after closing */
	/* What the device really gave, valid while open: */
	enum pixel_format format;
	int width, height;
	double rate_hz;
	bool on_demand; /* each grab() makes the next frame: waiting loses nothing */
	enum camera_situation situation;
	uint64_t frames, lost,
		broken; /* handed out; gaps in sequence + superseded; skipped as unfit */
	void *state;	/* the driver's; NULL when closed */
};

/* One line a format: what `devices` prints. */
struct camera_listing {
	char device[INI_PATH_MAX];
	char name[128], bus[128];
	char (*lines)[160]; /* formats, sizes, rates, controls, for people */
	int line_count;
};

struct camera_ops {
	const char *name;	 /* "v4l2" */
	const char *description; /* one line */
	/* Optional: the driver's own keys, prefixed "name." in the file, and the struct they fill.
	 */
	const struct ini_key *keys;
	size_t options_size;

	/* Optional. Calls found() for each camera there is; the listing is valid during the call.
	 * Returns how many or -errno. */
	int (*list)(void (*found)(void *context, const struct camera_listing *listing),
		    void *context);

	/* Mandatory. From settings and options to streaming; sets name, format, width, height,
	 * rate_hz and state. On failure sets situation, says why, and leaves nothing open. May
	 * block (start of a device), at most 2 s: the program calls it on a thread of its own, and
	 * no other op until it has returned. */
	int (*open)(struct camera *camera, struct fault *fault);

	/* Mandatory. A descriptor that polls readable when grab() has something to do. */
	int (*descriptor)(struct camera *camera);

	/* Mandatory, never blocks. Takes the newest frame; older ones that wait are given back to
	 * the driver and counted lost; unfit ones are counted broken. frame's memory is the
	 * driver's until release(). At most one frame is out at a time. 0; -EAGAIN: none yet;
	 * -ENODEV: gone; -ESTALE: close it and open it at once, as the source sends another size or
	 * standard now, or the driver wants to begin anew; other -errno: broken, close it. */
	int (*grab)(struct camera *camera, struct frame *frame, struct fault *fault);

	/* Mandatory. Gives the frame back. Its memory stays readable until a grab() that gives
	 * another or close(), though what is in it may change. */
	void (*release)(struct camera *camera, struct frame *frame);

	/* Mandatory. Idempotent; the only cleanup; accepts a half-open camera. */
	void (*close)(struct camera *camera);

	/* Optional. Changes a control while the camera streams; name and value as in
	 * camera_settings.controls. Takes as long as the device takes to answer, some milliseconds
	 * mostly. Frames that were captured before, and some after it, still show the old value:
	 * how many is the device's affair. Where the device says at once that it made another
	 * number of value, as cameras with steps do, taken gets that; else it stays. 0; -EINVAL: no
	 * control of that name, or no value of its; -ERANGE: out of its range, which the fault
	 * names; -ENOTSUP: this camera has none that can be changed now; other -errno: the device
	 * refuses it. The camera goes on streaming, whatever is returned. */
	int (*control)(struct camera *camera, const char *name, const char *value, double *taken,
		       struct fault *fault);
};

/* Drivers count lost and broken and may set the situation; the wrappers count frames, make the
 * situation fine with each frame and name it where a driver that fails has not. Closing keeps
 * counts and situation for whoever reports them. A camera that is not open: -EBADF. */
int camera_open(struct camera *camera, const struct camera_ops *ops,
		const struct camera_settings *settings, void *options, struct fault *fault);
int camera_descriptor(struct camera *camera);
int camera_grab(struct camera *camera, struct frame *frame, struct fault *fault);
void camera_release(struct camera *camera, struct frame *frame);
/* -ENOTSUP also where the driver has no such op. taken: NULL where nobody wants to know. */
int camera_set_control(struct camera *camera, const char *name, const char *value, double *taken,
		       struct fault *fault);
void camera_close(struct camera *camera); /* zeroed is fine */

#endif
