/* SPDX-License-Identifier: MIT */
/* The parts of buttons_keyboard.c: names of keys, and what the events of a device mean. */
#ifndef INLAY_DRIVERS_KEYBOARD_KEYBOARD_H
#define INLAY_DRIVERS_KEYBOARD_KEYBOARD_H

#include <linux/input.h>
#include <stdbool.h>

#include "hal/base/fault.h"
#include "hal/device/buttons.h"

/*
 * Maps keys to actions. The configuration names keys, as in "up equal kpplus"; here they become
 * codes of evdev. The names are those of <linux/input-event-codes.h> in small letters without KEY_;
 * buttons of joysticks and arcade encoders keep their prefix (btn_trigger). A step of a dial or a
 * wheel is a key, too, one for each direction.
 */

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

/*
 * Turns the events of one evdev device into presses. Pure: touches no device. A key that is down at
 * the start is no press, and neither are its repetitions by the kernel. Other repetitions count as
 * presses if the action repeats. After the kernel has dropped events, further events are ignored
 * until the owner has asked the device which keys are down. A finger on a touch screen without
 * a key is the key btn_touch.
 */

#define KEYS_BITS_BYTES (KEYMAP_CODES / 8) /* size of the bits of EVIOCGKEY, EVIOCGBIT(EV_KEY) */

struct keys {
	unsigned char down[KEYS_BITS_BYTES];   /* keys that were pressed since the start */
	unsigned char before[KEYS_BITS_BYTES]; /* keys that are down since before the start */
	bool dropped;			       /* events were dropped; true until SYN_REPORT */
	bool ask;			       /* the owner must call keys_ask() */
	bool contacts; /* set by the owner: the device has fingers and no key btn_touch */
};

static inline bool keys_bit(const unsigned char *bits, unsigned code)
{
	return bits[code / 8] >> (code % 8) & 1;
}

/* now: bits of the keys that are down already. */
void keys_start(struct keys *keys, const unsigned char *now);

/* Whether no key is down. */
bool keys_are_idle(const struct keys *keys);

/* Takes an event. Returns the action that is pressed, or ACTION_NONE. */
enum action keys_take(struct keys *keys, const struct keymap *map, const struct input_event *event);

/* Call it when keys->ask is set. now: bits of the keys that are down. Keys that went down unseen
 * are presses: the first one's action is returned, the others are lost. */
enum action keys_ask(struct keys *keys, const struct keymap *map, const unsigned char *now);

#endif
