/* SPDX-License-Identifier: MIT */
#include "hal/device/buttons.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

const char *const action_names[] = {
	"none",	     "threshold-up", "threshold-down", "threshold-next", "threshold-set",
	"view-next", "view",	     "pose-next",      "pose-prev",	 "pose",
	"object",    "information",  "split-left",     "split-right",	 "freeze",
	"wake",	     "learn",	     "forget",	       "quit",		 NULL,
};

_Static_assert(sizeof(action_names) / sizeof(action_names[0]) == ACTION_COUNT + 1,
	       "a name for each action");

static enum action find_action(const char *name)
{
	for (int i = ACTION_NONE + 1; i < ACTION_COUNT; i++)
		if (!strcmp(name, action_names[i]))
			return (enum action)i;
	return ACTION_NONE;
}

static int unknown_action(const char *name, struct fault *fault)
{
	const char *near = ini_nearest(name, action_names + ACTION_NONE + 1,
				       ACTION_COUNT - ACTION_NONE - 1);

	return fault_say(fault, -EINVAL, "unknown action \"%.40s\"%s%s%s", name,
			 near ? ", did you mean \"" : ", expected one like view-next",
			 near ? near : "", near ? "\"?" : "");
}

static int parse_level(const char *text, struct button_press *press)
{
	struct ini_level level;
	const int err = ini_level_read(text, ACTION_LEVEL_MAX, &level);

	if (!err) {
		press->value = level.value;
		press->percent = level.percent;
	}
	return err;
}

static int parse_name(const char *text, struct button_press *press)
{
	if (!text || !*text || strlen(text) >= sizeof(press->name))
		return -EINVAL;
	strcpy(press->name, text);
	return 0;
}

static int parse_pose(const char *text, struct button_press *press, struct fault *fault)
{
	if (parse_name(text, press))
		return fault_say(
			fault, -EINVAL,
			"pose needs a value, expected next, prev, or the number or name of a pose");
	if (!strcmp(text, "next"))
		*press = (struct button_press){.action = ACTION_POSE_NEXT};
	else if (!strcmp(text, "prev"))
		*press = (struct button_press){.action = ACTION_POSE_PREV};
	return 0;
}

static int parse_view(const char *text, struct button_press *press, struct fault *fault)
{
	if (parse_name(text, press))
		return fault_say(fault, -EINVAL,
				 "view needs a value, expected next or the name of a view");
	if (!strcmp(text, "next"))
		*press = (struct button_press){.action = ACTION_VIEW_NEXT};
	return 0;
}

static bool is_switch(enum action action)
{
	return action == ACTION_OBJECT || action == ACTION_INFORMATION || action == ACTION_FREEZE;
}

static int parse_turn(const char *name, const char *text, struct button_press *press,
		      struct fault *fault)
{
	bool on;

	if (!ini_truth_read(text, &on))
		return fault_say(fault, -EINVAL, "%s takes on, off or nothing, found \"%.40s\"",
				 name, text);
	press->turn = on ? TURN_ON : TURN_OFF;
	return 0;
}

int button_press_parse(const char *name, const char *value, struct button_press *press,
		       struct fault *fault)
{
	*press = (struct button_press){.action = find_action(name)};
	switch (press->action) {
	case ACTION_NONE:
		return unknown_action(name, fault);
	case ACTION_THRESHOLD_SET:
		if (value && !parse_level(value, press))
			return 0;
		return fault_say(
			fault, -EINVAL,
			"threshold-set needs a level, expected one number 0..%.0f or a percentage 0%%..100%%",
			ACTION_LEVEL_MAX);
	case ACTION_POSE_SET:
		return parse_pose(value, press, fault);
	case ACTION_VIEW_SET:
		return parse_view(value, press, fault);
	default:
		if (!value)
			return 0;
		if (is_switch(press->action))
			return parse_turn(name, value, press, fault);
		return fault_say(fault, -EINVAL, "%s takes no value, found \"%.40s\"", name, value);
	}
}

bool action_repeats(enum action action)
{
	return action == ACTION_THRESHOLD_UP || action == ACTION_THRESHOLD_DOWN ||
	       action == ACTION_SPLIT_LEFT || action == ACTION_SPLIT_RIGHT;
}

int buttons_open(struct buttons *buttons, const struct buttons_ops *ops, void *options,
		 struct fault *fault)
{
	int err;

	*buttons = (struct buttons){0};
	if (!ops || (ops->options_size && !options))
		return fault_say(fault, -EINVAL, "buttons are opened without driver or options");
	buttons->ops = ops;
	buttons->options = options;
	err = ops->open(buttons, fault);
	if (err) {
		ops->close(buttons);
		*buttons = (struct buttons){0};
	}
	return err;
}

int buttons_descriptor(struct buttons *buttons)
{
	return buttons->state ? buttons->ops->descriptor(buttons) : -EBADF;
}

int buttons_read(struct buttons *buttons, struct button_press *press, struct fault *fault)
{
	*press = (struct button_press){.action = ACTION_NONE};
	if (!buttons->state)
		return fault_say(fault, -EBADF, "buttons that are not open");
	return buttons->ops->read(buttons, press, fault);
}

void buttons_close(struct buttons *buttons)
{
	if (buttons->ops && buttons->state)
		buttons->ops->close(buttons);
	buttons->state = NULL;
}
