/* SPDX-License-Identifier: MIT */
/*
 * Which key is which action: from names in the configuration, as in "up equal kpplus", to evdev's
 * codes. The names are those of <linux/input-event-codes.h> in small letters without KEY_; buttons
 * of joysticks and arcade encoders keep theirs (btn_trigger).
 */
#ifndef INLAY_DRIVERS_KEYBOARD_KEYMAP_H
#define INLAY_DRIVERS_KEYBOARD_KEYMAP_H

#include "hal/base/fault.h"
#include "hal/device/buttons.h"

#define KEYMAP_CODES 0x300 /* as many codes as there are: KEY_CNT */

struct keymap {
	unsigned char actions[KEYMAP_CODES]; /* enum action of each code */
};

/* Adds the keys that names lists, separated by blanks; none is fine. what: the configuration's key,
 * for the fault. 0, or -EINVAL: an unknown key, or one that has an action already. */
int keymap_add(struct keymap *map, enum action action, const char *names, const char *what,
	       struct fault *fault);

/* The code of a key's name, or -1. */
int keymap_code(const char *name);

#endif
