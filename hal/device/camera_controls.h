/* SPDX-License-Identifier: MIT */
/* camera_settings.controls taken apart: "name=value, name=value". What the names and the values
 * mean is the driver's. */
#ifndef INLAY_HAL_DEVICE_CAMERA_CONTROLS_H
#define INLAY_HAL_DEVICE_CAMERA_CONTROLS_H

#include "hal/base/fault.h"
#include "hal/ini/ini.h"

enum { CAMERA_CONTROL_NAME_MAX = 64 };

/* One assignment, without the blanks around name and value; neither is empty. */
struct camera_control {
	char name[CAMERA_CONTROL_NAME_MAX];
	char value[INI_TEXT_MAX];
};

/* Takes the next assignment off the text; nothing between two commas is none. 1; 0: no more;
 * -EINVAL: not of that form or too long, which the fault quotes, and the text goes on behind it. */
int camera_controls_next(const char **text, struct camera_control *control, struct fault *fault);

#endif
