/* SPDX-License-Identifier: MIT */
/*
 * Maps keys to actions. The configuration names keys, as in "up equal kpplus"; here they become
 * codes of evdev. The names are those of <linux/input-event-codes.h> in small letters without KEY_;
 * buttons of joysticks and arcade encoders keep their prefix (btn_trigger). A step of a dial or a
 * wheel is a key, too, one for each direction.
 */
#ifndef INLAY_DRIVERS_KEYBOARD_KEYMAP_H
#define INLAY_DRIVERS_KEYBOARD_KEYMAP_H

#include "hal/base/fault.h"
#include "hal/device/buttons.h"

/* Number of codes: KEY_CNT of keys, then two for each of REL_CNT axes. */
#define KEYMAP_CODES 0x320
#define KEYMAP_TURN(axis, steps) (0x300U + 2U * (axis) + ((steps) < 0))

struct keymap {
	unsigned char actions[KEYMAP_CODES]; /* enum action of each code */
};

/* Adds keys for an action. names: names of keys separated by blanks, or empty. what: the key of the
 * configuration, for the fault. 0; -EINVAL: an unknown key, or one that has an action already. */
int keymap_add(struct keymap *map, enum action action, const char *names, const char *what,
	       struct fault *fault);

/* Returns the code of a key's name, or -1. */
int keymap_code(const char *name);

#endif
