/* SPDX-License-Identifier: MIT */
/* A device's controls by name: set from the configuration after each opening, listed for people. */
#ifndef INLAY_DRIVERS_V4L2_CONTROLS_H
#define INLAY_DRIVERS_V4L2_CONTROLS_H

#include <linux/videodev2.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/base/fault.h"
#include "hal/device/camera_controls.h"

enum { V4L2_CONTROLS_MAX = 32, V4L2_CONTROL_NAME_MAX = 64 };

struct v4l2_setting {
	struct camera_control said;
	struct v4l2_query_ext_ctrl control; /* id is 0 while it is not known */
	int64_t wanted, taken;
};

struct v4l2_settings {
	struct v4l2_setting list[V4L2_CONTROLS_MAX];
	int count;
};

/* Reads camera_settings.controls. -EINVAL: not of that form, or too many. */
int v4l2_controls_read(struct v4l2_settings *settings, const char *text, struct fault *fault);

/* Sets them in the order in which they are written: a driver refuses a manual value while the
 * automatic is on. Reads each back; what is refused or comes back as another value is logged, path
 * first, once however often the camera is opened, and keeps nobody from going on. */
void v4l2_controls_apply(int fd, const char *path, struct v4l2_settings *settings);

/* Once the device streams: sets those again that it has put back meanwhile. */
void v4l2_controls_confirm(int fd, const char *path, struct v4l2_settings *settings);

/* Changes one on the way. 0; -EINVAL: unknown, or no value of its; -ERANGE; or what the device
 * says, with a fault. Of a number that it makes another of, taken gets that, and it is logged. */
int v4l2_control_change(int fd, const char *path, const char *name, const char *value,
			double *taken, struct fault *fault);

/* A control's name as it is written in the configuration (and as v4l2-ctl writes it):
 * "White Balance, Automatic" is white_balance_automatic. */
void v4l2_control_name(const char *said, char name[V4L2_CONTROL_NAME_MAX]);

/* The next control after this one (id 0: the first) that has one number for a value. False: no
 * more. */
bool v4l2_next_control(int fd, struct v4l2_query_ext_ctrl *control);

/* A menu's entry as text, or false where the menu has a hole. */
bool v4l2_menu_entry(int fd, const struct v4l2_query_ext_ctrl *control, int64_t index,
		     char text[V4L2_CONTROL_NAME_MAX]);

int v4l2_get_control(int fd, const struct v4l2_query_ext_ctrl *control, int64_t *value);

#endif
