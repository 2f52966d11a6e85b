/* SPDX-License-Identifier: MIT */
#include "drivers/keyboard/keyboard.h"

#include <string.h>

static void set_bit(unsigned char *bits, unsigned code, bool on)
{
	const unsigned char bit = (unsigned char)(1U << (code % 8));

	if (on)
		bits[code / 8] |= bit;
	else
		bits[code / 8] &= (unsigned char)~bit;
}

void keys_start(struct keys *keys, const unsigned char *now)
{
	*keys = (struct keys){.ask = false};
	memcpy(keys->before, now, sizeof(keys->before));
}

bool keys_are_idle(const struct keys *keys)
{
	for (unsigned i = 0; i < KEYS_BITS_BYTES; i++)
		if (keys->down[i] || keys->before[i])
			return false;
	return true;
}

enum action keys_take(struct keys *keys, const struct keymap *map, const struct input_event *event)
{
	struct input_event touch = {.type = EV_KEY, .code = BTN_TOUCH, .value = event->value >= 0};
	enum action action;
	bool was_down;

	if (keys->contacts && event->type == EV_ABS && event->code == ABS_MT_TRACKING_ID)
		event = &touch;
	if (event->type == EV_SYN) {
		if (event->code == SYN_DROPPED)
			keys->dropped = true;
		if (event->code == SYN_REPORT && keys->dropped) {
			keys->dropped = false;
			keys->ask = true;
		}
	}
	if (event->type == EV_REL && !keys->dropped && event->code < REL_CNT && event->value)
		return (enum action)map->actions[KEYMAP_TURN(event->code, event->value)];
	if (event->type != EV_KEY || keys->dropped || event->code >= KEY_CNT)
		return ACTION_NONE;
	action = (enum action)map->actions[event->code];
	was_down = keys_bit(keys->down, event->code);
	if (event->value == 2) /* a repetition by the kernel */
		return was_down && action_repeats(action) ? action : ACTION_NONE;
	set_bit(keys->down, event->code, event->value);
	if (!event->value)
		set_bit(keys->before, event->code, false);
	return event->value && !was_down ? action : ACTION_NONE;
}

enum action keys_ask(struct keys *keys, const struct keymap *map, const unsigned char *now)
{
	enum action pressed = ACTION_NONE;

	keys->ask = false;
	for (unsigned code = 0; code < KEYMAP_CODES; code++) {
		const bool down = keys_bit(now, code),
			   before = down && keys_bit(keys->before, code);

		if (down && !before && !keys_bit(keys->down, code) && pressed == ACTION_NONE)
			pressed = (enum action)map->actions[code];
		set_bit(keys->before, code, before);
		set_bit(keys->down, code, down && !before);
	}
	return pressed;
}
