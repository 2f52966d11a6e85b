/* SPDX-License-Identifier: MIT */
#include "hal/device/display.h"

#include <errno.h>

const char *const display_situation_names[] = {
	"fine",	   "no device", "no screen", "busy", "no permission",
	"no mode", "stalled",	"broken",    NULL,
};

_Static_assert(sizeof(display_situation_names) / sizeof(display_situation_names[0]) ==
		       DISPLAY_SITUATION_COUNT + 1,
	       "a name for each situation");

/* Sets the situation after an error, unless the driver has set it. */
static void name_situation(struct display *display, int err)
{
	if (!err || display->situation != DISPLAY_FINE)
		return;
	display->situation = err == -ENODEV			 ? DISPLAY_NO_DEVICE
			     : err == -ENOLINK || err == -ESTALE ? DISPLAY_NO_SCREEN
			     : err == -EACCES || err == -EPERM	 ? DISPLAY_NO_PERMISSION
			     : err == -EBUSY			 ? DISPLAY_BUSY
			     : err == -ETIMEDOUT		 ? DISPLAY_STALLED
								 : DISPLAY_BROKEN;
}

bool display_may_return(enum display_situation situation)
{
	switch (situation) {
	case DISPLAY_NO_DEVICE:
	case DISPLAY_NO_SCREEN:
	case DISPLAY_BUSY:
	case DISPLAY_STALLED:
		return true;
	default:
		return false;
	}
}

int display_open(struct display *display, const struct display_ops *ops,
		 const struct display_settings *settings, void *options, struct fault *fault)
{
	int err;

	*display = (struct display){0};
	if (!ops || !settings || (ops->options_size && !options))
		return fault_say(fault, -EINVAL, "a display is opened without driver or settings");
	display->ops = ops;
	display->settings = *settings;
	display->options = options;
	err = ops->open(display, fault);
	if (err) {
		name_situation(display, err);
		ops->close(display, NULL);
		*display = (struct display){.ops = ops, .situation = display->situation};
	}
	return err;
}

int display_descriptor(struct display *display)
{
	return display->state ? display->ops->descriptor(display) : -EBADF;
}

int display_fit(struct display *display, int width, int height, double squash)
{
	if (!display->state)
		return -EBADF;
	return display->ops->fit ? display->ops->fit(display, width, height, squash) : -ENOTSUP;
}

int display_acquire(struct display *display, struct display_buffer *buffer)
{
	int err;

	*buffer = (struct display_buffer){0};
	if (!display->state)
		return -EBADF;
	err = display->ops->acquire(display, buffer);
	if (err)
		return err;
	display->acquired = true;
	display->acquired_index = buffer->index;
	return 0;
}

int display_submit(struct display *display, struct display_buffer *buffer, int64_t token,
		   struct fault *fault)
{
	int err;

	if (!display->state)
		return fault_say(fault, -EBADF, "a display that is not open");
	if (!buffer->pixels || !display->acquired || buffer->index != display->acquired_index)
		return fault_say(fault, -EINVAL, "a display buffer that was not acquired");
	err = display->ops->submit(display, buffer, token, fault);
	name_situation(display, err);
	display->acquired = false;
	*buffer = (struct display_buffer){0};
	return err;
}

int display_dispatch(struct display *display, struct display_event *event, struct fault *fault)
{
	int err;

	*event = (struct display_event){.kind = DISPLAY_NOTHING};
	if (!display->state)
		return fault_say(fault, -EBADF, "a display that is not open");
	err = display->ops->dispatch(display, event, fault);
	name_situation(display, err);
	if (!err && event->kind == DISPLAY_SHOWN)
		display->shown++;
	return err;
}

int display_close(struct display *display, struct fault *fault)
{
	int err = 0;

	if (display->ops && display->state)
		err = display->ops->close(display, fault);
	display->state = NULL;
	display->acquired = display->hidden = false;
	return err;
}

int display_free_size(const struct display *display, int *width, int *height, struct fault *fault)
{
	const struct display_settings *s = &display->settings;

	*width = s->width ? s->width : s->picture_width;
	*height = s->height ? s->height : s->picture_height;
	if (*width < 1 || *height < 1)
		return fault_say(fault, -EINVAL,
				 "the %s display is told neither its own size nor the picture's",
				 display->ops->name);
	return 0;
}
