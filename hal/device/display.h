/* SPDX-License-Identifier: MIT */
/*
 * Screens: the contract between the program and drivers/display_*.c.
 *
 * A display has two or three buffers of its own size. One of them at a time is drawn into, whole,
 * by the program; it is then submitted and shown at the next refresh. The memory may be
 * write-combined: write it once, in order, and never read it.
 */
#ifndef INLAY_HAL_DEVICE_DISPLAY_H
#define INLAY_HAL_DEVICE_DISPLAY_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/base/fault.h"
#include "hal/ini/ini.h"

/* What there is to say about a screen that cannot show anything. */
enum display_situation {
	DISPLAY_FINE,
	DISPLAY_NO_DEVICE, /* no graphics card, no window system */
	DISPLAY_NO_SCREEN, /* nothing connected, or it is off */
	DISPLAY_BUSY,	   /* another program holds it */
	DISPLAY_NO_PERMISSION,
	DISPLAY_NO_MODE, /* it has none that was asked for */
	DISPLAY_STALLED, /* a refresh never came */
	DISPLAY_BROKEN,	 /* anything else; the fault says what */
	DISPLAY_SITUATION_COUNT
};

extern const char *const display_situation_names[]; /* "fine", "no device", ... NULL */

struct display_settings {
	char device[INI_PATH_MAX]; /* driver's own meaning: a card, an output file; empty: first
				      found */
	int width, height;	   /* wanted; 0: the driver's choice (hints below) */
	double rate_hz;		   /* wanted; 0: the driver's choice */
	int picture_width,
		picture_height; /* of what will be shown: the size of drivers that are free */
};

struct display_ops;

struct display {
	const struct display_ops *ops;
	struct display_settings settings;
	void *options; /* the driver's own struct; borrowed */
	/* What there really is, valid while open: */
	int width, height;
	double rate_hz; /* 0: as fast as it is fed */
	bool hidden;	/* the console is switched to somebody else: acquire() says -EAGAIN */
	enum display_situation situation; /* kept after closing and after a failure to open */
	uint64_t shown;			  /* frames that reached the screen */
	void *state;			  /* the driver's; NULL when closed */
	/* The wrappers' own: */
	bool acquired;
	int acquired_index;
};

struct display_buffer {
	uint8_t *pixels; /* BGRX */
	size_t stride;
	int width, height;
	int index; /* the driver's own handle */
};

enum display_event_kind {
	DISPLAY_NOTHING,
	DISPLAY_SHOWN,	 /* a submitted frame is on the screen since time_ns */
	DISPLAY_CLOSED,	 /* the person closed the window: stop */
	DISPLAY_EXPOSED, /* what was on the screen is lost (the console is ours again), and so is
			    what was submitted and is not told of yet: draw anew */
	DISPLAY_ACTION, /* a key pressed in the window: action holds enum action (hal/device/buttons.h) */
};

struct display_event {
	enum display_event_kind kind;
	int64_t time_ns; /* CLOCK_MONOTONIC */
	int64_t token;	 /* as given to submit() */
	int action;
};

/* What `devices` prints. */
struct display_listing {
	char device[INI_PATH_MAX];
	char name[128];
	char (*lines)[160];
	int line_count;
};

struct display_ops {
	const char *name;
	const char *description;
	const struct ini_key *keys; /* optional, prefixed "name." */
	size_t options_size;

	/* Optional; as camera_ops.list. */
	int (*list)(void (*found)(void *context, const struct display_listing *listing),
		    void *context);

	/* Mandatory. Sets width, height, rate_hz, state. What a failure leaves half-open,
	 * display_open() has closed. */
	int (*open)(struct display *display, struct fault *fault);

	/* Mandatory. Polls readable when dispatch() has something to do; -1: never. */
	int (*descriptor)(struct display *display);

	/* Optional. Pictures of this size are to fill the screen, letterboxed, their pixels
	 * height/width = squash. 0: the hardware does it, and acquire() gives buffers of this size
	 * from now on; -ENOTSUP: it cannot, they stay as large as the screen. Nothing is allocated
	 * for a size asked before. */
	int (*fit)(struct display *display, int width, int height, double squash);

	/* Mandatory, never blocks. A buffer to draw in. -EAGAIN: all are queued or on the screen.
	 * The same buffer is returned until it is submitted. */
	int (*acquire)(struct display *display, struct display_buffer *buffer);

	/* Mandatory, never blocks. Shows what was acquired; token comes back in DISPLAY_SHOWN, but
	 * for a frame that the console's being switched away overtook: that one is lost. 0 or
	 * -errno: the screen is gone or the disk is full; situation says which; close it. */
	int (*submit)(struct display *display, struct display_buffer *buffer, int64_t token,
		      struct fault *fault);

	/* Mandatory, never blocks. One event per call until DISPLAY_NOTHING. 0; -ESTALE: the
	 * connector or its modes changed; other -errno: it is gone, or a flip that was due never
	 * came. After any of them: close it, and open it again when situation lets hope. */
	int (*dispatch)(struct display *display, struct display_event *event, struct fault *fault);

	/* Mandatory. Idempotent, accepts what open() left half-done; gives the screen back as it
	 * was; finishes files. 0, or -errno with a fault when something that was promised could not
	 * be finished. */
	int (*close)(struct display *display, struct fault *fault);
};

/*
 * What callers use. -EBADF: not open; -EINVAL: a buffer that was not acquired, or no op table. A
 * display that failed to open is closed and zeroed but for ops and situation.
 */
int display_open(struct display *display, const struct display_ops *ops,
		 const struct display_settings *settings, void *options, struct fault *fault);
int display_descriptor(struct display *display);
int display_fit(struct display *display, int width, int height, double squash);
int display_acquire(struct display *display, struct display_buffer *buffer);
int display_submit(struct display *display, struct display_buffer *buffer, int64_t token,
		   struct fault *fault);
int display_dispatch(struct display *display, struct display_event *event, struct fault *fault);
int display_close(struct display *display, struct fault *fault); /* zeroed is fine */

/* Whether waiting may mend it: a screen that is plugged in, a program that lets go of it. */
bool display_may_return(enum display_situation situation);

/* For drivers whose size is free: what was asked for, else the picture's. -EINVAL: neither. */
int display_free_size(const struct display *display, int *width, int *height, struct fault *fault);

#endif
