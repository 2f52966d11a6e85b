/* SPDX-License-Identifier: MIT */
/*
 * Cameras: the contract between the program and drivers/camera_*.c.
 *
 * Callers use the wrappers below, never the pointers. One thread owns a camera. Settings do not
 * change while a camera is open; run-time state is apart from them.
 */
#ifndef INLAY_HAL_DEVICE_CAMERA_H
#define INLAY_HAL_DEVICE_CAMERA_H

#include <stdbool.h>
#include <stdio.h>

#include "hal/base/fault.h"
#include "hal/frame/frame.h"
#include "hal/ini/ini.h"

/* State of a camera, for the screen and the journal. */
enum camera_situation {
	CAMERA_FINE,
	CAMERA_NO_DEVICE,
	CAMERA_NO_SIGNAL,
	CAMERA_STALLED,
	CAMERA_DAMAGED, /* frames come, and none of them decodes */
	CAMERA_UNSUPPORTED_FORMAT,
	CAMERA_BUSY,
	CAMERA_NO_BANDWIDTH,
	CAMERA_NO_PERMISSION,
	CAMERA_BROKEN, /* anything else; the fault says what */
	CAMERA_SITUATION_COUNT
};

extern const char *const camera_situation_names[]; /* "fine", "no device", ... NULL */

struct camera_settings {
	char device[INI_PATH_MAX]; /* the driver defines its meaning; empty: the first found */
	int width, height;	   /* wanted, in pixels; 0: the driver's choice */
	double rate_hz;		   /* wanted; 0: the driver's choice */
	int format;  /* enum pixel_format wanted; PIXEL_NONE: the cheapest to convert */
	int buffers; /* 2..8 */
	int matrix;  /* enum colour_matrix + 1; 0: as the driver says */
	int range;   /* enum colour_range + 1; 0: as the driver says */
	/* "name=value, name=value", names and values as `devices` lists them. Set after every
	 * opening and read back. The camera opens even if a control is refused; the refusal is
	 * logged. */
	char controls[INI_TEXT_MAX];
	/* Wishes to give up, in this order, when the bus has too little bandwidth: words of
	 * "format", "size", "rate"; empty: none. */
	char give_up[INI_TEXT_MAX];
};

struct camera_ops;

struct camera {
	const struct camera_ops *ops;
	struct camera_settings settings;
	void *options;	/* the driver's own struct, ops->options_size bytes; borrowed */
	char name[128]; /* the device's own name; empty: not known. Kept after closing */
	/* What the device really delivers, valid while open: */
	enum pixel_format format;
	int width, height;
	double rate_hz;
	bool on_demand; /* each grab() makes the next frame: a late grab() loses none */
	enum camera_situation situation;
	int64_t keyless_ns; /* when a picture came last that lacks its key frame; 0: none did */
	uint64_t frames, lost,
		broken; /* frames given out; gaps in sequence + superseded; unfit and skipped */
	void *state;	/* the driver's; NULL when closed */
};

/* One camera in the output of `inlay devices`. */
struct camera_listing {
	char device[INI_PATH_MAX];
	char name[128], bus[128];
	char (*lines)[160]; /* text: formats, sizes, rates, controls */
	int line_count;
};

struct camera_ops {
	const char *name;	 /* "v4l2" */
	const char *description; /* one line */
	/* Optional: the driver's own keys, prefixed "name." in the file, and the size of the struct
	 * that they fill. */
	const struct ini_key *keys;
	size_t options_size;

	/* Optional. Calls found() for each camera; the listing is valid during the call. Returns
	 * the number of cameras or -errno. */
	int (*list)(void (*found)(void *context, const struct camera_listing *listing),
		    void *context);

	/* Mandatory. Opens the device and starts streaming; sets name, format, width, height,
	 * rate_hz and state. On failure sets situation and fault, and leaves nothing open. May
	 * block for at most 2 s (start of a device): the program calls it on a thread of its own,
	 * and no other op until it has returned. */
	int (*open)(struct camera *camera, struct fault *fault);

	/* Mandatory. A descriptor that polls readable when grab() has something to do. */
	int (*descriptor)(struct camera *camera);

	/* Mandatory, never blocks. Takes the newest frame; requeues older waiting ones and counts
	 * them lost; counts unfit ones broken. The driver owns the frame's memory, which the caller
	 * may read until release(). At most one frame is out at a time. 0; -EAGAIN: none yet;
	 * -ENODEV: the device is gone; -ESTALE: close and reopen it at once, because the source
	 * changed its size or standard or the driver must restart; other -errno: broken, close
	 * it. */
	int (*grab)(struct camera *camera, struct frame *frame, struct fault *fault);

	/* Mandatory. Gives the frame back. Its memory stays readable until the next successful
	 * grab() or close(), but its content may change. */
	void (*release)(struct camera *camera, struct frame *frame);

	/* Mandatory. Idempotent; the only cleanup; accepts a half-open camera. */
	void (*close)(struct camera *camera);

	/* Optional. Changes a control while the camera streams; name and value as in
	 * camera_settings.controls. Blocks until the device answers, mostly some milliseconds.
	 * Frames captured before, and a number after that depends on the device, still show the old
	 * value. If the device reports at once that it rounded the value (cameras with steps do),
	 * *taken gets the rounded value; else *taken stays. 0; -EINVAL: unknown control, or not a
	 * value of it; -ERANGE: out of range, which the fault names; -ENOTSUP: this camera has no
	 * control that can change now; other -errno: the device refuses. The camera streams on in
	 * every case. */
	int (*control)(struct camera *camera, const char *name, const char *value, double *taken,
		       struct fault *fault);
};

/*
 * The wrappers that callers use. -EBADF: the camera is not open. Drivers count lost and broken and
 * may set the situation. The wrappers count frames, set the situation to fine with each frame, and
 * set it after a failure if the driver has not. Closing keeps counts and situation for reports.
 */
int camera_open(struct camera *camera, const struct camera_ops *ops,
		const struct camera_settings *settings, void *options, struct fault *fault);
int camera_descriptor(struct camera *camera);
int camera_grab(struct camera *camera, struct frame *frame, struct fault *fault);
void camera_release(struct camera *camera, struct frame *frame);
/* -ENOTSUP also where the driver has no such op. taken may be NULL. */
int camera_set_control(struct camera *camera, const char *name, const char *value, double *taken,
		       struct fault *fault);
void camera_close(struct camera *camera); /* zeroed is fine */

/* The situation that an error of a camera's device stands for. */

/* err: negative errno of a Linux camera driver. */
enum camera_situation camera_situation_of(int err);

/* Whether an opening that failed like this would always fail under this configuration: the device
 * is no camera, or does not know the setting. Other failures may pass with time,
 * such as those of a USB camera while its bus starts or of a digitizer while its source starts. */
bool camera_is_hopeless(enum camera_situation situation, int err);

/* Choice among the formats that a camera offers. */

/* Merit of a format; larger is better; 0: the program does not decode it from cameras. size: the
 * format has the wanted size; rate: it has the wanted rate at that size. Formats with both come
 * first, then those with the size, then the rest. Among equals the cheaper conversion wins: full
 * colour without conversion, 4:2:2, 4:2:0, compressed, grey; then video, then depths. */
int camera_format_merit(enum pixel_format format, bool size, bool rate);

/* Parser of camera_settings.controls: "name=value, name=value". The driver defines names and
 * values. */

enum { CAMERA_CONTROL_NAME_MAX = 64 };

/* One assignment, without blanks around name and value; neither is empty. */
struct camera_control {
	char name[CAMERA_CONTROL_NAME_MAX];
	char value[INI_TEXT_MAX];
};

/* Reads the next assignment and moves *text behind it; skips empty ones. 1: there is one; 0: end of
 * the text; -EINVAL: wrong form or too long, the fault quotes it, and *text is behind it. */
int camera_controls_next(const char **text, struct camera_control *control, struct fault *fault);

#endif
