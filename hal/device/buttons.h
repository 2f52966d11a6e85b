/* SPDX-License-Identifier: MIT */
/*
 * Buttons: the contract between the program and drivers/buttons_*.c. The program sees named
 * actions, whatever the hardware. Several drivers may be in use at once.
 */
#ifndef INLAY_HAL_DEVICE_BUTTONS_H
#define INLAY_HAL_DEVICE_BUTTONS_H

#include <stdbool.h>

#include "hal/base/fault.h"
#include "hal/ini/ini.h"

enum action {
	ACTION_NONE,
	ACTION_THRESHOLD_UP,
	ACTION_THRESHOLD_DOWN,
	ACTION_THRESHOLD_NEXT, /* up, and from the highest to 0: for a single button */
	ACTION_THRESHOLD_SET,  /* to value, a level or a percentage */
	ACTION_VIEW_NEXT,
	ACTION_VIEW_SET, /* to the view of this name */
	ACTION_POSE_NEXT,
	ACTION_POSE_PREV,
	ACTION_POSE_SET,    /* to the pose of this name or number */
	ACTION_OBJECT,	    /* shows or hides the object: a switch */
	ACTION_INFORMATION, /* shows or hides the line of figures: a switch */
	ACTION_SPLIT_LEFT,  /* moves the line between before and after */
	ACTION_SPLIT_RIGHT,
	ACTION_FREEZE, /* holds the picture or lets it go on: a switch */
	ACTION_WAKE,   /* ends the rest outside of opening hours for a while */
	ACTION_LEARN,  /* nobody is in the picture: it shows the empty place */
	ACTION_FORGET, /* the empty place is learned anew */
	ACTION_QUIT,
	ACTION_COUNT
};

extern const char *const action_names[]; /* "none", "threshold-up", ... NULL */

#define BUTTON_NAME_MAX 32     /* with its NUL */
#define ACTION_LEVEL_MAX 255.0 /* largest level of ACTION_THRESHOLD_SET */

/* What a press does to an action that is a switch. */
enum turn { TURN_OVER, TURN_ON, TURN_OFF };

struct button_press {
	enum action action;
	double value;	/* ACTION_THRESHOLD_SET: level, 0..ACTION_LEVEL_MAX */
	bool percent;	/* value is a percentage, 0..100 */
	enum turn turn; /* switches */
	/* ACTION_POSE_SET: name or number of the pose; ACTION_VIEW_SET: name of the view. */
	char name[BUTTON_NAME_MAX];
};

/* Parses a press as a person writes it: the name of an action and, only where it takes one,
 * a value (NULL: none). "pose next", "pose prev" and "view next" are pose-next, pose-prev and
 * view-next; a switch takes on, off, or nothing, which turns it over. 0; -EINVAL with a
 * fault that says what was expected. */
int button_press_parse(const char *name, const char *value, struct button_press *press,
		       struct fault *fault);

/* Whether the action repeats while its button is held: steps do, toggles do not. */
bool action_repeats(enum action action);

struct buttons_ops;

struct buttons {
	const struct buttons_ops *ops;
	void *options; /* borrowed */
	void *state;   /* the driver's; NULL when closed */
};

struct buttons_ops {
	const char *name;
	const char *description;
	const struct ini_key *keys; /* optional, prefixed "name." */
	size_t options_size;

	/* Optional. Calls found() with one line of text for each device and each input line. 0 or
	 * -errno. */
	int (*list)(void (*found)(void *context, const char *line), void *context);

	/* Mandatory. 0 or -errno; after a failure buttons_open() calls close(). The program calls
	 * it again every second until it succeeds: a missing chip does not stop the kiosk. */
	int (*open)(struct buttons *buttons, struct fault *fault);
	/* Mandatory. A descriptor that polls readable when read() has a press. */
	int (*descriptor)(struct buttons *buttons);
	/* Mandatory, never blocks. 0 and a press; -EAGAIN: none; other -errno: the device is gone,
	 * close it. */
	int (*read)(struct buttons *buttons, struct button_press *press, struct fault *fault);
	/* Mandatory, idempotent; accepts a half-open state. */
	void (*close)(struct buttons *buttons);
};

/* The wrappers that callers use. -EBADF: not open. Buttons that failed to open are closed and
 * zeroed. */
int buttons_open(struct buttons *buttons, const struct buttons_ops *ops, void *options,
		 struct fault *fault);
int buttons_descriptor(struct buttons *buttons);
int buttons_read(struct buttons *buttons, struct button_press *press, struct fault *fault);
void buttons_close(struct buttons *buttons);

#endif
