/* SPDX-License-Identifier: MIT */
/* A device's controls by name: set from the configuration at each opening, listed for people. */
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
	struct v4l2_query_ext_ctrl control; /* id 0: not looked up, or given up */
	int64_t wanted, taken;		    /* from the configuration; read back */
};

struct v4l2_settings {
	struct v4l2_setting list[V4L2_CONTROLS_MAX];
	int count;
};

/* Reads camera_settings.controls. 0; -EINVAL: malformed, or too many. */
int v4l2_controls_read(struct v4l2_settings *settings, const char *text, struct fault *fault);

/* Sets the controls in the order in which they are written, because a driver refuses a manual value
 * while its automatic is on. Reads each one back. A control that is refused or reads back as
 * another value is logged, once however often the camera is opened, and does not stop the rest.
 * path begins the messages. */
void v4l2_controls_apply(int fd, const char *path, struct v4l2_settings *settings);

/* Call it once the device streams: sets those controls again that starting has changed. */
void v4l2_controls_confirm(int fd, const char *path, struct v4l2_settings *settings);

/* Changes one control while the camera runs. 0; -EINVAL: unknown control or malformed value;
 * -ERANGE; other -errno of the device, with a fault. If the device rounds the number, *taken
 * becomes what it uses, and this is logged. */
int v4l2_control_change(int fd, const char *path, const char *name, const char *value,
			double *taken, struct fault *fault);

/* Converts a control's name to the form of the configuration (and of v4l2-ctl):
 * "White Balance, Automatic" becomes white_balance_automatic. */
void v4l2_control_name(const char *said, char name[V4L2_CONTROL_NAME_MAX]);

/* Replaces *control by the next one (id 0: the first) whose value is one number. False: no more. */
bool v4l2_next_control(int fd, struct v4l2_query_ext_ctrl *control);

/* Writes a menu's entry as text. False: the menu has no entry of this index. */
bool v4l2_menu_entry(int fd, const struct v4l2_query_ext_ctrl *control, int64_t index,
		     char text[V4L2_CONTROL_NAME_MAX]);

int v4l2_get_control(int fd, const struct v4l2_query_ext_ctrl *control, int64_t *value);

#endif
