#include "hal/buttons.h"

#include <errno.h>

const char *const action_names[] = {
	"none",	     "threshold-up", "threshold-down", "threshold-next", "threshold-set",
	"view-next", "pose-next",    "object",	       "information",	 "split-left",
	"split-right", "freeze",     "quit",	       NULL,
};

_Static_assert(sizeof(action_names) / sizeof(action_names[0]) == ACTION_COUNT + 1,
	       "a name for each action");

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
