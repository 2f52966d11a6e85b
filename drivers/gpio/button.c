/* SPDX-License-Identifier: MIT */
#include "drivers/gpio/gpio.h"

void button_start(struct button *button, bool level, bool repeats)
{
	*button = (struct button){.repeats = repeats, .pressed = level, .repeat_ns = BUTTON_NEVER};
}

bool button_take(struct button *button, const struct button_timing *timing, bool level,
		 int64_t at_ns)
{
	const bool press = level && !button->pressed;

	if (press) {
		button->pressed_ns = at_ns;
		if (button->repeats && timing->repeat_after_ns)
			button->repeat_ns = at_ns + timing->repeat_after_ns;
	}
	if (!level)
		button->repeat_ns = BUTTON_NEVER;
	button->pressed = level;
	return press;
}

bool button_repeat(struct button *button, const struct button_timing *timing, int64_t now_ns)
{
	const bool stuck = now_ns - button->pressed_ns >= BUTTON_STUCK_NS;

	if (now_ns < button->repeat_ns)
		return false;
	/* Counted from now, not from the due time: a delayed program does not catch up. */
	button->repeat_ns = stuck ? BUTTON_NEVER : now_ns + timing->repeat_every_ns;
	return !stuck;
}
