/* SPDX-License-Identifier: MIT */
/*
 * Screens: the contract between the program and drivers/display_*.c.
 *
 * A display has two or three buffers of its own size. The program acquires one, draws all of it,
 * and submits it; the display shows it at the next refresh. The memory may be write-combined: write
 * it once, in order, and never read it.
 */
#ifndef INLAY_HAL_DEVICE_DISPLAY_H
#define INLAY_HAL_DEVICE_DISPLAY_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/base/fault.h"
#include "hal/frame/frame.h"
#include "hal/ini/ini.h"

/* State of a screen; all but DISPLAY_FINE say why it shows nothing. */
enum display_situation {
	DISPLAY_FINE,
	DISPLAY_NO_DEVICE, /* no graphics card, no window system */
	DISPLAY_NO_SCREEN, /* no screen connected, or it is off */
	DISPLAY_BUSY,	   /* another program holds it */
	DISPLAY_NO_PERMISSION,
	DISPLAY_NO_MODE, /* the screen lacks the wanted mode */
	DISPLAY_STALLED, /* a refresh never came */
	DISPLAY_BROKEN,	 /* anything else; the fault says what */
	DISPLAY_SITUATION_COUNT
};

extern const char *const display_situation_names[]; /* "fine", "no device", ... NULL */

struct display_settings {
	char device[INI_PATH_MAX]; /* the driver defines its meaning: a card, an output file;
				      empty: the first found */
	int width, height;	   /* wanted, in pixels; 0: the driver's choice */
	double rate_hz;		   /* wanted; 0: the driver's choice */
	int picture_width,
		picture_height; /* size of the picture: the choice of drivers without a size */
	int turn;		/* enum picture_turn */
	/* Black at the left, top, right and bottom of the screen as it is driven, before the turn:
	 * what a television's frame hides. Pixels. */
	double margins[4];
};

struct display_buffer {
	uint8_t *pixels; /* BGRX */
	size_t stride;
	int width, height;
	int index; /* the driver's own handle */
};

struct display_ops;

struct display {
	const struct display_ops *ops;
	struct display_settings settings;
	void *options; /* the driver's own struct; borrowed */
	/* What the screen really has, valid while open: */
	int width, height;
	double rate_hz; /* 0: no refresh; frames are taken as fast as they come */
	int mounted; /* enum picture_turn by which pictures are turned to be upright on a panel that
			   is built in otherwise; settings.turn is added */
	bool hidden; /* another console has the screen: acquire() returns -EAGAIN */
	bool off;    /* switched off by display_power(): display_acquire() returns -EAGAIN */
	enum display_situation situation; /* kept after closing and after a failure to open */
	uint64_t shown;			  /* frames that reached the screen */
	void *state;			  /* the driver's; NULL when closed */
	/* private to the wrappers: */
	bool acquired;
	int acquired_index;
	struct display_buffer whole; /* the driver's buffer that is acquired */
	struct canvas upright;	     /* drawn in place of it where the picture is turned */
};

enum display_event_kind {
	DISPLAY_NOTHING,
	DISPLAY_SHOWN,	 /* a submitted frame has been on the screen since time_ns */
	DISPLAY_CLOSED,	 /* the person closed the window: stop */
	DISPLAY_EXPOSED, /* the console is back; the picture on the screen and submitted frames that
			    had no DISPLAY_SHOWN are lost: draw again */
	DISPLAY_ACTION,	 /* a key was pressed in the window: action is an enum action
			    (hal/device/buttons.h) */
};

struct display_event {
	enum display_event_kind kind;
	int64_t time_ns; /* CLOCK_MONOTONIC */
	int64_t token;	 /* the one given to submit() */
	int action;
};

/* One screen in the output of `inlay devices`. */
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

	/* Optional; the same contract as camera_ops.list. */
	int (*list)(void (*found)(void *context, const struct display_listing *listing),
		    void *context);

	/* Mandatory. Sets width, height, rate_hz, state. 0 or -errno; after a failure
	 * display_open() calls close(). */
	int (*open)(struct display *display, struct fault *fault);

	/* Mandatory. A descriptor that polls readable when dispatch() has something to do; -1:
	 * none. */
	int (*descriptor)(struct display *display);

	/* Optional. Asks the hardware to scale pictures of this size to the screen, letterboxed;
	 * squash is height / width of a picture's pixel. 0: it does, and acquire() gives buffers of
	 * this size from now on; -ENOTSUP: it cannot, buffers stay as large as the screen. A size
	 * asked for before allocates nothing. */
	int (*fit)(struct display *display, int width, int height, double squash);

	/* Optional. Switches the screen off, or on again; what was on it and submitted frames
	 * without DISPLAY_SHOWN are lost. display->off still tells how it is. 0 or -errno: the
	 * screen is gone, close it. */
	int (*power)(struct display *display, bool on, struct fault *fault);

	/* Mandatory, never blocks. Returns a buffer to draw in, the same one until it is submitted.
	 * 0; -EAGAIN: all buffers are queued or on the screen. */
	int (*acquire)(struct display *display, struct display_buffer *buffer);

	/* Mandatory, never blocks. Shows the acquired buffer at the next refresh (page flip). token
	 * comes back in DISPLAY_SHOWN, unless the console is switched away first: that frame is
	 * lost. 0; -errno: the screen is gone or the disk is full; situation says which; close it.
	 */
	int (*submit)(struct display *display, struct display_buffer *buffer, int64_t token,
		      struct fault *fault);

	/* Mandatory, never blocks. Returns one event per call until DISPLAY_NOTHING. 0; -ESTALE:
	 * the connector or its modes changed; other -errno: the screen is gone, or a page flip
	 * never completed. After any error close it; open it again if display_may_return(). */
	int (*dispatch)(struct display *display, struct display_event *event, struct fault *fault);

	/* Mandatory, idempotent; accepts a half-open state. Restores the screen as it was; finishes
	 * files. 0, or -errno with a fault when a file could not be finished. */
	int (*close)(struct display *display, struct fault *fault);
};

/*
 * The wrappers that callers use. Drivers say how the panel is mounted, and know nothing of turn and
 * margins: a buffer that display_acquire() gives is the upright part of the screen within them, and
 * display_submit() turns it (3 to 7 ms of one core for 1920x1080). display_fit() is refused then.
 * -EBADF: not open; -EINVAL: a buffer that was not acquired, or no ops table. A display that failed
 * to open is closed and zeroed except for ops and situation.
 */
int display_open(struct display *display, const struct display_ops *ops,
		 const struct display_settings *settings, void *options, struct fault *fault);
int display_descriptor(struct display *display);
int display_fit(struct display *display, int width, int height, double squash);
/* -ENOTSUP: the driver cannot. What is so already is no error. */
int display_power(struct display *display, bool on, struct fault *fault);
int display_acquire(struct display *display, struct display_buffer *buffer);
int display_submit(struct display *display, struct display_buffer *buffer, int64_t token,
		   struct fault *fault);
int display_dispatch(struct display *display, struct display_event *event, struct fault *fault);
int display_close(struct display *display, struct fault *fault); /* zeroed is fine */

/* Whether the situation may pass with time: a screen is plugged in, a program releases it. */
bool display_may_return(enum display_situation situation);

/* The size for drivers that have none of their own: the wanted one, else the picture's. -EINVAL:
 * neither is set. */
int display_free_size(const struct display *display, int *width, int *height, struct fault *fault);

#endif
