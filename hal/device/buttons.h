/* SPDX-License-Identifier: MIT */
/*
 * Buttons: the contract between the program and drivers/buttons_*.c. Whatever the hardware, the
 * program sees named actions. Several drivers may be in use at once.
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
	ACTION_THRESHOLD_SET,  /* value: the level, or percentage */
	ACTION_VIEW_NEXT,
	ACTION_POSE_NEXT,
	ACTION_POSE_PREV,
	ACTION_POSE_SET,    /* name: of the pose, or its number */
	ACTION_OBJECT,	    /* shown or not */
	ACTION_INFORMATION, /* the line of figures, shown or not */
	ACTION_SPLIT_LEFT,  /* moves the line between before and after */
	ACTION_SPLIT_RIGHT,
	ACTION_FREEZE,
	ACTION_QUIT,
	ACTION_COUNT
};

extern const char *const action_names[]; /* "none", "threshold-up", ... NULL */

#define BUTTON_NAME_MAX 32     /* with its NUL */
#define ACTION_LEVEL_MAX 255.0 /* of ACTION_THRESHOLD_SET */

struct button_press {
	enum action action;
	double value;		    /* of ACTION_THRESHOLD_SET: 0..ACTION_LEVEL_MAX */
	bool percent;		    /* the value is one, 0..100 */
	char name[BUTTON_NAME_MAX]; /* of ACTION_POSE_SET */
};

/* A press as a person writes it: the name of an action and, for threshold-set and pose alone, its
 * value; "pose next" and "pose prev" are pose-next and pose-prev. value: NULL when there is none.
 * 0, or -EINVAL and what was expected. */
int button_press_parse(const char *name, const char *value, struct button_press *press,
		       struct fault *fault);

/* Whether the action goes on while its button is held: steps do, toggles do not. */
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

	/* Optional. Hands found() one line of text for each device and line there is. 0 or -errno.
	 */
	int (*list)(void (*found)(void *context, const char *line), void *context);

	/* Mandatory. What a failure leaves half-open, buttons_open() has closed. Called again each
	 * second until it succeeds: a missing chip does not stop the kiosk. */
	int (*open)(struct buttons *buttons, struct fault *fault);
	/* Mandatory. Polls readable when read() has something. */
	int (*descriptor)(struct buttons *buttons);
	/* Mandatory, never blocks. 0 and a press; -EAGAIN: none; other -errno: gone, close it. */
	int (*read)(struct buttons *buttons, struct button_press *press, struct fault *fault);
	/* Mandatory, idempotent; accepts what open() left half-done. */
	void (*close)(struct buttons *buttons);
};

/* What callers use. -EBADF: not open. Buttons that failed to open are closed and zeroed. */
int buttons_open(struct buttons *buttons, const struct buttons_ops *ops, void *options,
		 struct fault *fault);
int buttons_descriptor(struct buttons *buttons);
int buttons_read(struct buttons *buttons, struct button_press *press, struct fault *fault);
void buttons_close(struct buttons *buttons);

#endif
