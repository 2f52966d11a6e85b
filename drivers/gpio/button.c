/* SPDX-License-Identifier: MIT */
#include "drivers/gpio/button.h"

void button_start(struct button *button, bool level, bool repeats)
{
	*button = (struct button){
		.repeats = repeats,
		.level = level,
		.pressed = level,
		.repeat_ns = BUTTON_NEVER,
	};
}

/* Takes over the level once it has lasted. True: this is a press. */
static bool level_settle(struct button *button, const struct button_timing *timing, int64_t now_ns)
{
	if (button->level == button->pressed || now_ns - button->edge_ns < timing->settle_ns)
		return false;
	button->pressed = button->level;
	button->pressed_ns = button->edge_ns;
	button->repeat_ns = button->pressed && button->repeats && timing->repeat_after_ns
				    ? button->edge_ns + timing->settle_ns + timing->repeat_after_ns
				    : BUTTON_NEVER;
	return button->pressed;
}

bool button_edge(struct button *button, const struct button_timing *timing, bool level,
		 int64_t at_ns)
{
	bool press;

	if (level == button->level)
		return false; /* the edge between was lost */
	press = level_settle(button, timing, at_ns);
	button->level = level;
	button->edge_ns = at_ns;
	return press;
}

bool button_settle(struct button *button, const struct button_timing *timing, int64_t now_ns)
{
	if (level_settle(button, timing, now_ns))
		return true;
	if (now_ns < button->repeat_ns || !button->level)
		return false;
	if (now_ns - button->pressed_ns >= BUTTON_STUCK_NS) {
		button->repeat_ns = BUTTON_NEVER;
		return false;
	}
	/* Counted from now, not from the due time: a delayed program does not catch up. */
	button->repeat_ns = now_ns + timing->repeat_every_ns;
	return true;
}

int64_t button_deadline_ns(const struct button *button, const struct button_timing *timing)
{
	if (button->level != button->pressed)
		return button->edge_ns + timing->settle_ns;
	return button->level ? button->repeat_ns : BUTTON_NEVER;
}
