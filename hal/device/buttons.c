/* SPDX-License-Identifier: MIT */
#include "hal/device/buttons.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

const char *const action_names[] = {
	"none",		 "threshold-up", "threshold-down", "threshold-next",
	"threshold-set", "view-next",	 "pose-next",	   "pose-prev",
	"pose",		 "object",	 "information",	   "split-left",
	"split-right",	 "freeze",	 "quit",	   NULL,
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

static int parse_pose(const char *text, struct button_press *press, struct fault *fault)
{
	if (!text || !*text || strlen(text) >= sizeof(press->name))
		return fault_say(
			fault, -EINVAL,
			"pose needs a value, expected next, prev, or the number or name of "
			"a pose");
	if (!strcmp(text, "next"))
		press->action = ACTION_POSE_NEXT;
	else if (!strcmp(text, "prev"))
		press->action = ACTION_POSE_PREV;
	else
		strcpy(press->name, text);
	return 0;
}

int button_press_parse(const char *name, const char *value, struct button_press *press,
		       struct fault *fault)
{
	*press = (struct button_press){.action = find_action(name)};
	if (press->action == ACTION_NONE)
		return unknown_action(name, fault);
	if (press->action == ACTION_THRESHOLD_SET) {
		if (!value || parse_level(value, press))
			return fault_say(
				fault, -EINVAL,
				"threshold-set needs a level, expected one number 0..%.0f or a "
				"percentage 0%%..100%%",
				ACTION_LEVEL_MAX);
	} else if (press->action == ACTION_POSE_SET) {
		return parse_pose(value, press, fault);
	} else if (value) {
		return fault_say(fault, -EINVAL, "%s takes no value, found \"%.40s\"", name, value);
	}
	return 0;
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
