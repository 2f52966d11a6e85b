/* SPDX-License-Identifier: MIT */
/* Parser of camera_settings.controls: "name=value, name=value". The driver defines names and
 * values. */
#ifndef INLAY_HAL_DEVICE_CAMERA_CONTROLS_H
#define INLAY_HAL_DEVICE_CAMERA_CONTROLS_H

#include "hal/base/fault.h"
#include "hal/ini/ini.h"

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
