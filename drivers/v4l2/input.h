/* SPDX-License-Identifier: MIT */
/* What a device receives: its inputs, television standards, HDMI timings, and whether there is a
 * signal. */
#ifndef INLAY_DRIVERS_V4L2_INPUT_H
#define INLAY_DRIVERS_V4L2_INPUT_H

#include <linux/videodev2.h>
#include <stdbool.h>

#include "hal/base/fault.h"
#include "hal/ini/ini.h"

/* The driver's own keys. */
struct v4l2_options {
	char input[INI_TEXT_MAX];    /* number or name; empty: the one that is selected */
	char standard[INI_TEXT_MAX]; /* empty: as detected */
	int field;		     /* enum v4l2_field_wish */
};

struct v4l2_source {
	int input;	      /* -1: the device knows no inputs */
	v4l2_std_id standard; /* 0: not television */
	bool tells;	      /* of changes, by events */
};

/* Selects the input, sets or takes over the television standard or HDMI timings that it receives,
 * and asks for events when those change. -EINVAL: no such input or standard; -ENOLINK, -ENOLCK,
 * -ERANGE: there is no signal, it is not stable, or none that can be received. */
int v4l2_setup_input(int fd, const struct v4l2_options *options, struct v4l2_source *source,
		     struct fault *fault);

/* 0, or -ENOLINK or -ENOLCK with a sentence. */
int v4l2_check_signal(int fd, const struct v4l2_source *source, struct fault *fault);

/* An event came that says that the source sends something else now. */
bool v4l2_source_changed(int fd);

/* Whether two names of standards or inputs mean the same: case and punctuation do not count. */
bool v4l2_same_name(const char *a, const char *b);

#endif
