/* SPDX-License-Identifier: MIT */
/*
 * From evdev's events to presses, for one device; no device in it. A key that was down before
 * anything was read is no press, nor is what the kernel repeats for it; a repetition counts for
 * actions that repeat. When the kernel dropped events, what it says afterwards is not believed
 * until the owner has asked it which keys are down.
 */
#ifndef INLAY_DRIVERS_KEYBOARD_KEYS_H
#define INLAY_DRIVERS_KEYBOARD_KEYS_H

#include <linux/input.h>
#include <stdbool.h>

#include "drivers/keyboard/keymap.h"

#define KEYS_BITS_BYTES (KEYMAP_CODES / 8) /* what EVIOCGKEY and EVIOCGBIT(EV_KEY) fill */

struct keys {
	unsigned char down[KEYS_BITS_BYTES];   /* pressed since the start */
	unsigned char before[KEYS_BITS_BYTES]; /* down at the start, and not let go since */
	bool dropped;			       /* until the report ends */
	bool ask;			       /* the owner is to call keys_ask() */
};

static inline bool keys_bit(const unsigned char *bits, unsigned code)
{
	return bits[code / 8] >> (code % 8) & 1;
}

/* now: a bit for each key that is down already. */
void keys_start(struct keys *keys, const unsigned char *now);

/* No key is down. */
bool keys_are_idle(const struct keys *keys);

/* ACTION_NONE: no press. */
enum action keys_take(struct keys *keys, const struct keymap *map, const struct input_event *event);

/* After keys->ask: now holds a bit for each key that is down. A key that went down unseen is a
 * press, of which the first is returned and the others are lost. */
enum action keys_ask(struct keys *keys, const struct keymap *map, const unsigned char *now);

#endif
