/* SPDX-License-Identifier: MIT */
/* Sets up what a digitizer receives: its input, television standard or HDMI timings; and checks the
 * signal. */
#ifndef INLAY_DRIVERS_V4L2_INPUT_H
#define INLAY_DRIVERS_V4L2_INPUT_H

#include <linux/videodev2.h>
#include <stdbool.h>

#include "hal/base/fault.h"
#include "hal/ini/ini.h"

/* The driver's own keys: [camera NAME] v4l2.*. */
struct v4l2_options {
	char input[INI_TEXT_MAX];    /* number or name; empty: the present one */
	char standard[INI_TEXT_MAX]; /* empty: as detected */
	int field;		     /* enum v4l2_field_wish */
};

struct v4l2_source {
	int input;	      /* -1: the device has no inputs */
	v4l2_std_id standard; /* 0: not television */
	bool tells;	      /* the device reports changes by events */
};

/* Selects the input, sets the television standard or HDMI timings as configured or as detected, and
 * subscribes to events about changes. 0; -EINVAL: no such input or standard; -ENOLINK: no signal;
 * -ENOLCK: the signal is not stable; -ERANGE: the device cannot receive this signal. */
int v4l2_setup_input(int fd, const struct v4l2_options *options, struct v4l2_source *source,
		     struct fault *fault);

/* Checks that there is a stable signal. 0; -ENOLINK, -ENOLCK with a fault. */
int v4l2_check_signal(int fd, const struct v4l2_source *source, struct fault *fault);

/* Reads pending events. True: one says that the source now sends another format. */
bool v4l2_source_changed(int fd);

/* Whether two names of standards or inputs are the same up to case and punctuation. */
bool v4l2_same_name(const char *a, const char *b);

#endif
